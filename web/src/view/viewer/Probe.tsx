/** What the pointer is on: its distance, and how sharp it is. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { formatDistance } from "../../model/distance";
import { gateWidthMm, readMap } from "../../model/focus_map";
import { formatCircle, holdingStop } from "../../model/sharpness";
import { formatStop } from "../../model/stops";
import { limitOf } from "../sharp_limit";
import { stopsInWords } from "./FocusOverlay";

export function Probe({ editor, session }: { editor: Editor; session: Session }): JSX.Element | null {
  const at = session.probed.value;
  const shown = session.pictures.displayed.value;
  const limitMm = limitOf(editor, session);
  const { probe, unit, delivery } = editor.remembered;
  if (probe.value === "off" || at === null || !shown?.focusMap || limitMm === null) return null;
  const { depthM, cocMm } = readMap(shown.focusMap, at);
  const isSharp = Math.abs(cocMm) <= limitMm;
  const fStop = session.document.readout.value?.fStop ?? 0;
  const [x, y] = at;
  const side = `${x > 0.5 ? " to-left" : ""}${y > 0.75 ? " upwards" : ""}`;
  return (
    <p
      class={`probe${side}`}
      role={session.crosshair.isHeld.value ? "status" : undefined}
      style={{ left: `${100 * x}%`, top: `${100 * y}%` }}
      data-depth-m={depthM}
      data-coc-mm={cocMm}
    >
      <strong>{formatDistance(depthM, unit.value)}</strong> {isSharp ? "in focus" : cocMm < 0 ? "in front" : "behind"}
      <br />
      {formatCircle(cocMm, gateWidthMm(shown.focusMap), Number(delivery.value))}
      <br />
      {stopsInWords(cocMm, limitMm)}
      {!isSharp && fStop > 0 && <>, sharp at {formatStop(holdingStop(fStop, cocMm, limitMm))}</>}
    </p>
  );
}
