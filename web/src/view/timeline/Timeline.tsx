/** Time at the foot of the page: transport, scrubber, the focus curve under it, and the points' keys under that. */

import type { JSX, RefObject } from "preact";
import { useCallback, useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import type { LengthUnit } from "../../model/distance";
import { Splitter } from "../controls/Splitter";
import { CurveChart } from "./CurveChart";
import { followPointer, useSize } from "../hooks";
import { KeyLanes } from "./KeyLanes";
import { KeyMenu, type MenuPlace } from "./KeyMenu";
import { Scrubber } from "./Scrubber";
import { timeAxis, type TimeAxis } from "./time_axis";
import { Transport } from "./Transport";
import { RingPanel } from "../ring/RingPanel";
import { ValueGraph } from "./ValueGraph";

export function Timeline({ editor }: { editor: Editor }): JSX.Element {
  const session = editor.session.value;
  return (
    <section class="timeline" aria-label="Timeline">
      {session ? (
        <Tracks editor={editor} session={session} unit={editor.remembered.unit.value} />
      ) : (
        <p class="muted pad-all">The focus curve of a shot shows here.</p>
      )}
    </section>
  );
}

function Tracks({ editor, session, unit }: { editor: Editor; session: Session; unit: LengthUnit }): JSX.Element {
  const box = useRef<HTMLDivElement>(null);
  const chart = useRef<HTMLDivElement>(null);
  const { width } = useSize(box);
  const [menu, setMenu] = useState<MenuPlace | null>(null);
  const closeMenu = useCallback(() => {
    setMenu(null);
  }, []);
  const span = session.timeView.span.value;
  const axis = useMemo(() => timeAxis(session.shot.range, span, width), [session, span, width]);
  useWheel(box, session, axis);
  const scrub = (down: PointerEvent): void => {
    if (down.button !== 0) return;
    const left = box.current?.getBoundingClientRect().left ?? 0;
    const goTo = (event: PointerEvent): void => {
      session.playhead.goTo(axis.time(event.clientX - left));
    };
    session.playhead.scrubbing.value = true;
    goTo(down);
    followPointer(down, goTo, () => {
      session.playhead.scrubbing.value = false;
    });
  };
  return (
    <>
      {editor.layout.isShown("curve") && (
        <Splitter layout={editor.layout} panel="curve" label="Height of the curve" of={chart} />
      )}
      <RingPanel session={session} unit={unit} />
      <Transport session={session} unit={unit} />
      <div
        class="tracks"
        ref={box}
        onContextMenu={(event) => {
          const target = event.target instanceof Element ? event.target : null;
          if (!target?.closest(".lanes, .graph")) return;
          event.preventDefault();
          selectForMenu(session, target);
          setMenu({ x: event.clientX, y: event.clientY });
        }}
      >
        {width > 0 && (
          <>
            <Scrubber session={session} axis={axis} onScrub={scrub} />
            {editor.layout.isShown("curve") && (
              <>
                <div ref={chart}>
                  <Chart session={session} axis={axis} unit={unit} onScrub={scrub} />
                </div>
                <KeyLanes session={session} axis={axis} />
              </>
            )}
            <Playhead session={session} axis={axis} />
          </>
        )}
      </div>
      {menu && <KeyMenu editor={editor} place={menu} close={closeMenu} />}
    </>
  );
}

/** Selects the key that a menu is opened on, unless it is one of those that are selected. */
function selectForMenu({ keys }: Session, target: Element): void {
  const key = target.closest<HTMLElement>("[data-stack], [data-knot]");
  const id = key?.dataset.stack ?? key?.dataset.knot;
  if (id === undefined || keys.selected.value.has(id)) return;
  keys.select(keys.lanes.value.flatMap(({ stacks }) => stacks.filter((stack) => stack.id === id)));
}

interface ChartProps {
  readonly session: Session;
  readonly axis: TimeAxis;
  readonly unit: LengthUnit;
  readonly onScrub: (down: PointerEvent) => void;
}

/** The focus curve, or the curve of a value that has keys, as is chosen. */
function Chart(props: ChartProps): JSX.Element {
  const graph = props.session.keys.graph.value;
  if (!graph) return <CurveChart {...props} />;
  return <ValueGraph key={graph.saved.id} {...props} curve={graph.shown} saved={graph.saved} />;
}

/** Zooms at the pointer by the wheel, and pans by Shift and the wheel; lanes that scroll zoom by Ctrl and the wheel. */
function useWheel(box: RefObject<HTMLDivElement | null>, { timeView }: Session, axis: TimeAxis): void {
  useEffect(() => {
    const element = box.current;
    const turned = (event: WheelEvent): void => {
      const lanes = event.target instanceof Element ? event.target.closest(".lanes") : null;
      const scrolls = lanes !== null && lanes.scrollHeight > lanes.clientHeight;
      if (scrolls && !event.ctrlKey && !event.shiftKey) return;
      event.preventDefault();
      const { deltaX, deltaY } = event;
      const isAcross = event.shiftKey || Math.abs(deltaX) > Math.abs(deltaY);
      const left = element?.getBoundingClientRect().left ?? 0;
      if (isAcross) timeView.pan((deltaX || deltaY) / axis.perFrame);
      else timeView.zoom(WHEEL_ZOOM ** deltaY, axis.exactTime(event.clientX - left));
    };
    element?.addEventListener("wheel", turned, { passive: false });
    return () => {
      element?.removeEventListener("wheel", turned);
    };
  }, [box, timeView, axis]);
}

/** Zoom for each px that a wheel turns by. */
const WHEEL_ZOOM = 1.002;

function Playhead({ session, axis }: { session: Session; axis: TimeAxis }): JSX.Element | null {
  const time = session.playhead.time.value;
  if (!axis.has(time)) return null;
  const x = axis.x(time);
  return <div class="playhead" style={{ transform: `translateX(${x}px)` }} aria-hidden="true" />;
}
