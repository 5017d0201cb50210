/** The focus points on the picture: click one to select it, drag it to put it elsewhere. */

import type { JSX, TargetedPointerEvent } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import { MarkerDrag } from "../../editor/marker";
import type { Place } from "../../editor/picks";
import type { Session } from "../../editor/session";
import { formatDistance } from "../../model/distance";
import { formatOffset, judge } from "../../model/sharpness";
import { inFrame, type FocusPoint } from "../../model/shot";
import { followPointer } from "../hooks";
import { limitOf } from "../sharp_limit";

/** Distance of a pointer from which it drags, CSS px. */
const SLACK_PX = 4;

export function Markers({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  return (
    <div class="markers" role="group" aria-label="Focus points on the picture">
      {session.shownPoints.value.filter(inFrame).map((point) => (
        <Marker key={point.name} editor={editor} session={session} point={point} />
      ))}
    </div>
  );
}

/** Place of a click whose pick is under way. */
export function Picking({ session }: { session: Session }): JSX.Element | null {
  const at = session.picks.picking.value;
  return at && <div class="picking" style={place(at)} role="status" aria-label="Looking what is there" />;
}

/** A marker's drag, which is given up where the marker goes away in it, as where its point leaves the picture. */
function useMarkerDrag(
  session: Session,
  point: FocusPoint,
): { dragged: Place | null; onPointerDown: (down: TargetedPointerEvent<HTMLElement>) => void } {
  const [dragged, setDragged] = useState<Place | null>(null);
  const giveUp = useRef<(() => void) | null>(null);
  useEffect(() => () => giveUp.current?.(), []);
  const onPointerDown = (down: TargetedPointerEvent<HTMLElement>): void => {
    const frame = down.currentTarget.closest(".picture")?.getBoundingClientRect();
    if (!frame || down.button !== 0 || session.document.noEdits.value !== null) return;
    const drag = new MarkerDrag(session, point);
    let moves = false;
    const move = ({ clientX, clientY }: PointerEvent): void => {
      moves ||= Math.hypot(clientX - down.clientX, clientY - down.clientY) >= SLACK_PX;
      if (!moves) return;
      const at = [hold((clientX - frame.left) / frame.width), hold((clientY - frame.top) / frame.height)] as const;
      setDragged(at);
      drag.move(at);
    };
    const end = async (isDropped: boolean): Promise<void> => {
      giveUp.current = null;
      if (isDropped) await drag.drop();
      else drag.cancel();
      setDragged(null);
    };
    const stop = followPointer(down, move, ({ type }) => void end(type === "pointerup"));
    giveUp.current = () => {
      stop();
      drag.cancel();
    };
  };
  return { dragged, onPointerDown };
}

interface MarkerProps {
  readonly editor: Editor;
  readonly session: Session;
  readonly point: FocusPoint;
}

function Marker({ editor, session, point }: MarkerProps): JSX.Element {
  const { dragged, onPointerDown } = useMarkerDrag(session, point);
  const selected = session.selected.value === point.name;
  const active = point.settings.enabled && point.settings.weight > 0;
  const { unit } = editor.remembered;
  const depth = point.depthM === null ? "" : formatDistance(point.depthM, unit.value);
  const limitMm = limitOf(editor, session);
  const verdict = limitMm === null ? null : judge(session.sharpnessOf(point), limitMm);
  const said = verdict && (verdict.isSharp ? "sharp" : `soft, ${formatOffset(verdict.offsetM, unit.value)}`);
  return (
    <button
      type="button"
      class={`marker${selected ? " selected" : ""}${active ? "" : " idle"}`}
      style={place(dragged ?? point.screen ?? [0, 0])}
      aria-pressed={selected}
      aria-label={`Focus point ${[point.name, depth, said].filter(Boolean).join(" ")}`}
      onClick={() => (session.selected.value = point.name)}
      onPointerDown={onPointerDown}
    >
      <svg viewBox="-14 -14 28 28" width="28" height="28" aria-hidden="true">
        <g class="halo">
          <Reticle />
        </g>
        <g class="line">
          <Reticle />
        </g>
      </svg>
      <span class="tag" data-color={point.color}>
        {point.name} <small>{depth}</small>{" "}
        {verdict && <small class={verdict.isSharp ? "sharp" : "soft"}>{said}</small>}
      </span>
    </button>
  );
}

function Reticle(): JSX.Element {
  return (
    <>
      <path d="M-11 -6V-11H-6M6 -11H11V-6M11 6V11H6M-6 11H-11V6" />
      <circle r="2" />
    </>
  );
}

function place([x, y]: Place): { left: string; top: string } {
  return { left: `${x * 100}%`, top: `${y * 100}%` };
}

function hold(fraction: number): number {
  return Math.min(Math.max(fraction, 0), 0.9999);
}
