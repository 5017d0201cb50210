/** The focus distance in the set from above: a handle beside the field of view, which is dragged or moved by keys as the panel's slider is. */

import type { JSX, TargetedPointerEvent } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { Drag } from "../../editor/drag";
import type { Session } from "../../editor/session";
import { formatDistance, type LengthUnit } from "../../model/distance";
import { FOCUS_DISTANCES_M } from "../../model/scale";
import type { Readout } from "../../model/shot";
import { fromSheet, toSheet, type Sheet, type TopView } from "../../model/top_view";
import { FocusMoves } from "./focus_moves";
import { spotOf } from "./sheet";

interface HandleProps {
  readonly session: Session;
  readonly sheet: Sheet;
  readonly view: TopView;
  readonly readout: Readout;
  readonly unit: LengthUnit;
}

/** Room for the handle at the edges of the drawing, px. */
const EDGE_PX = 14;
/** How far it stands from the field of view, px: points are in there. */
const BESIDE_PX = 22;
/** Farthest that a drag sets, m; the keys go on to infinity. */
const FARTHEST_M = 10_000;

export function FocusHandle(props: HandleProps): JSX.Element {
  const { session, sheet, view, readout, unit } = props;
  const refusal = refusalOf(session, readout);
  const gestures = useGestures(props, refusal);
  const { focusDistanceM } = readout;
  const depth = Math.min(focusDistanceM, FARTHEST_M);
  const edge = Math.min(view.edges[0] * (depth + view.setBackM), 0);
  const [x, y] = toSheet(sheet, [edge - BESIDE_PX / sheet.pxPerM, depth]);
  const held = (px: number, size: number): number => Math.min(Math.max(px, EDGE_PX), size - EDGE_PX);
  const text = formatDistance(focusDistanceM, unit);
  return (
    <div
      class="plan-handle"
      role="slider"
      tabIndex={0}
      aria-label="Focus distance from above"
      aria-orientation="vertical"
      aria-valuemin={0}
      aria-valuemax={FARTHEST_M}
      aria-valuenow={Math.min(focusDistanceM, FARTHEST_M)}
      aria-valuetext={text}
      aria-disabled={refusal !== null}
      title={refusal ?? `Focus distance, ${text}: drag it, or use the arrow keys`}
      style={{ left: `${held(x, sheet.width)}px`, top: `${held(y, sheet.height)}px` }}
      {...gestures}
    />
  );
}

/** Why the distance is not set here; null where it is. */
function refusalOf({ document }: Session, { source }: Readout): string | null {
  if (document.noEdits.value !== null) return document.noEdits.value;
  return source === "points" ? "The focus points set the focus distance" : null;
}

interface Gestures {
  readonly onPointerDown: (down: TargetedPointerEvent<HTMLDivElement>) => void;
  readonly onKeyDown: (event: KeyboardEvent) => void;
  readonly onKeyUp: (event: KeyboardEvent) => void;
  readonly onBlur: () => void;
}

function useGestures({ session, sheet, readout }: HandleProps, refusal: string | null): Gestures {
  const [moves] = useState(() => new FocusMoves());
  useEffect(
    () => () => {
      moves.end(false);
    },
    [moves],
  );
  const start = (): Drag<number> => session.dragLens("focus distance", "focusDistanceM", readout);
  const moveTo = (value: number): void => {
    moves.move(value, start);
  };
  return {
    onPointerDown: (down) => {
      down.stopPropagation();
      const plan = down.currentTarget.closest(".plan");
      if (down.button !== 0 || !plan || refusal !== null) return;
      // It stays as far from the pointer as it is taken hold of.
      const grip = fromSheet(sheet, spotOf(plan, down))[1] - Math.min(readout.focusDistanceM, FARTHEST_M);
      const isTaken = Number.isFinite(readout.focusDistanceM) && Math.abs(grip) * sheet.pxPerM <= EDGE_PX * 2;
      const valueAt = (event: PointerEvent): number => {
        const depth = fromSheet(sheet, spotOf(plan, event))[1] - (isTaken ? grip : 0);
        return Math.min(Math.max(depth, FOCUS_DISTANCES_M.min), FARTHEST_M);
      };
      moves.follow(down, valueAt, start);
    },
    onKeyDown: (event) => {
      const count = STEPS[event.key];
      const value = moves.value ?? readout.focusDistanceM;
      if (event.key === "Escape" && moves.isTaken) moves.end(false);
      else if (refusal !== null || event.ctrlKey || event.metaKey || event.altKey) return;
      else if (event.key === "End") moveTo(Infinity);
      else if (event.key === "Home") moveTo(FOCUS_DISTANCES_M.min);
      else if (count !== undefined) moveTo(FOCUS_DISTANCES_M.step(value, event.shiftKey ? 10 * count : count));
      else return;
      event.preventDefault();
    },
    onKeyUp: ({ key }) => {
      if (STEPS[key] !== undefined || key === "Home" || key === "End") moves.end(true);
    },
    onBlur: () => {
      moves.end(true);
    },
  };
}

const STEPS: Readonly<Record<string, number>> = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1 };
