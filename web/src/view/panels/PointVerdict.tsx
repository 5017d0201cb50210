/** Whether focus points are sharp, and what would make them so. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { formatCircle, formatOffset, holdingStop, judge, missed } from "../../model/sharpness";
import { formatStop } from "../../model/stops";
import type { FocusPoint, Readout } from "../../model/shot";
import { gateOf, limitOf } from "../sharp_limit";

interface VerdictProps {
  readonly editor: Editor;
  readonly session: Session;
  readonly point: FocusPoint;
}

/** One point: sharp or soft, its distance from the focus, and its circle of confusion. */
export function PointVerdict({ editor, session, point }: VerdictProps): JSX.Element | null {
  const limitMm = limitOf(editor, session);
  const gateMm = gateOf(session);
  const verdict = limitMm === null ? null : judge(session.sharpnessOf(point), limitMm);
  if (verdict === null || gateMm === null) return null;
  const { isSharp, offsetM, cocMm } = verdict;
  const asked = point.settings.kind === "soft" && point.settings.blurMm > 0 ? point.settings.blurMm : null;
  return (
    <p class={`verdict ${isSharp ? "sharp" : "soft"}`}>
      <b>{isSharp ? "sharp" : "soft"}</b>{" "}
      <span title="Distance from the focus; + is behind it">{formatOffset(offsetM, editor.remembered.unit.value)}</span>{" "}
      <span title="Circle of confusion on the film, and in the delivered picture">
        {formatCircle(cocMm, gateMm, Number(editor.remembered.delivery.value))}
      </span>
      {asked !== null && <span title="Blur that the point asks for"> (asked for {asked.toFixed(2)} mm)</span>}
    </p>
  );
}

/** The points that the focus misses, and the stop that would hold them. */
export function Misses({
  editor,
  session,
  readout,
}: {
  editor: Editor;
  session: Session;
  readout: Readout;
}): JSX.Element | null {
  const limitMm = limitOf(editor, session);
  const points = session.document.points.value.map((point) => ({ ...point, sharpness: session.sharpnessOf(point) }));
  if (readout.focusMode === "manual" || limitMm === null || points.length === 0) return null;
  const misses = missed(points, limitMm);
  if (misses.length === 0) return null;
  const { unit } = editor.remembered;
  const worst = Math.max(...misses.map(({ verdict }) => verdict.cocMm));
  const names = misses.map(({ point, verdict }) => `${point.name} by ${formatOffset(verdict.offsetM, unit.value)}`);
  return (
    <p class="reason remark misses">
      The focus misses {listed(names)}.
      {readout.fStop > 0 && ` ${formatStop(holdingStop(readout.fStop, worst, limitMm))} would make all sharp.`}
    </p>
  );
}

/** Names as a sentence lists them. */
function listed(names: readonly string[]): string {
  return names.length < 2 ? names.join("") : `${names.slice(0, -1).join(", ")} and ${names.at(-1) ?? ""}`;
}
