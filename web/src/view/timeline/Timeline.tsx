/** Time at the foot of the page: transport, scrubber, the focus curve under it, and the points' keys under that. */

import type { JSX } from "preact";
import { useMemo, useRef } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import type { LengthUnit } from "../../model/distance";
import { CurveChart } from "./CurveChart";
import { followPointer, useSize } from "../hooks";
import { KeyLanes } from "./KeyLanes";
import { Scrubber } from "./Scrubber";
import { timeAxis, type TimeAxis } from "./time_axis";
import { Transport } from "./Transport";

export function Timeline({ editor }: { editor: Editor }): JSX.Element {
  const session = editor.session.value;
  return (
    <section class="timeline" aria-label="Timeline">
      {session ? (
        <Tracks session={session} unit={editor.remembered.unit.value} />
      ) : (
        <p class="muted pad-all">The focus curve of a shot shows here.</p>
      )}
    </section>
  );
}

function Tracks({ session, unit }: { session: Session; unit: LengthUnit }): JSX.Element {
  const box = useRef<HTMLDivElement>(null);
  const { width } = useSize(box);
  const axis = useMemo(() => timeAxis(session.shot.range, width), [session, width]);
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
      <Transport session={session} unit={unit} />
      <div class="tracks" ref={box}>
        {width > 0 && (
          <>
            <Scrubber session={session} axis={axis} onScrub={scrub} />
            <CurveChart session={session} axis={axis} unit={unit} onScrub={scrub} />
            <KeyLanes session={session} axis={axis} />
            <Playhead session={session} axis={axis} />
          </>
        )}
      </div>
    </>
  );
}

function Playhead({ session, axis }: { session: Session; axis: TimeAxis }): JSX.Element {
  const x = axis.x(session.playhead.time.value);
  return <div class="playhead" style={{ transform: `translateX(${x}px)` }} aria-hidden="true" />;
}
