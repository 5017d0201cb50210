/** A focus point in the set from above: a click selects it, a drag or the arrow keys move it at its height. */

import type { JSX, TargetedPointerEvent } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { PlanDrag, Standstill } from "../../editor/plan_drag";
import type { Session } from "../../editor/session";
import { formatDistance, type LengthUnit } from "../../model/distance";
import { fromSheet, toSheet, type Place, type Sheet, type Spot, type TopView } from "../../model/top_view";
import { followPointer } from "../hooks";
import { PlanMoves } from "./plan_moves";
import { offsetText, type PlanPoint } from "./points";
import { arrowOf, spotOf } from "./sheet";

interface MarkerProps {
  readonly session: Session;
  readonly sheet: Sheet;
  readonly view: TopView;
  readonly shown: PlanPoint;
  readonly unit: LengthUnit;
  /** By which an arrow key moves it. */
  readonly stepM: number;
  /** Shows it at a place; null shows it where it is saved. */
  readonly onDragged: (place: Place | null) => void;
}

/** Distance of a pointer from which it drags, CSS px. */
const SLACK_PX = 4;

export function PlanMarker(props: MarkerProps): JSX.Element {
  const { session, sheet, shown, unit } = props;
  const { name, point, place } = shown;
  const gestures = useGestures(props);
  const [x, y] = toSheet(sheet, place);
  const isSelected = session.selected.value === name;
  const isActive = point.settings.enabled && point.settings.weight > 0;
  const off = offsetText(shown, unit);
  const depth = formatDistance(place[1], unit);
  const refusal = session.document.noEdits.value;
  return (
    <button
      type="button"
      class={`plan-marker${isSelected ? " selected" : ""}${isActive ? "" : " idle"}`}
      style={{ left: `${x}px`, top: `${y}px` }}
      data-point={name}
      data-color={point.color}
      aria-pressed={isSelected}
      aria-label={`${off ? `${name} ${off}` : name}, from above, ${depth}${refusal === null ? "; the arrow keys move it" : ""}`}
      title={refusal ?? `Drag ${name}, or move it by the arrow keys: it keeps its height`}
      onClick={() => (session.selected.value = name)}
      {...gestures}
    >
      <i aria-hidden="true" />
      <span class="tag" data-color={point.color}>
        {name} {off && <small class="soft">{off}</small>}
      </span>
    </button>
  );
}

interface Gestures {
  readonly onPointerDown: (down: TargetedPointerEvent<HTMLButtonElement>) => void;
  readonly onKeyDown: (event: KeyboardEvent) => void;
  readonly onKeyUp: (event: KeyboardEvent) => void;
  readonly onBlur: () => void;
}

function useGestures(props: MarkerProps): Gestures {
  // By the first move of a pointer the marker may be drawn anew: its gesture begins with what is shown then.
  const now = useRef(props);
  now.current = props;
  const { session } = props;
  const [moves] = useState(
    () =>
      new PlanMoves((place) => {
        now.current.onDragged(place);
      }),
  );
  const standstill = useMemo(() => new Standstill(session), [session]);
  useEffect(() => () => void moves.end(false), [moves, session]);
  const mayMove = (): boolean => session.document.noEdits.value === null;
  const mayBegin = (): boolean => moves.isHeld || standstill.comesWith(now.current.shown.point, now.current.view);
  const moveTo = (to: Place): void => {
    moves.move(to, () => new PlanDrag(session, now.current.shown.point, now.current.view));
  };
  const grip = (): { readonly sheet: Sheet; readonly own: Spot } => {
    const { sheet, shown } = now.current;
    return { sheet, own: toSheet(sheet, moves.place ?? shown.place) };
  };
  return {
    onPointerDown: (down) => {
      down.stopPropagation();
      const plan = down.currentTarget.closest(".plan");
      if (down.button !== 0 || !plan || !mayMove()) return;
      const [startX, startY] = spotOf(plan, down);
      let held: ReturnType<typeof grip> | null = null;
      const unfollow = followPointer(
        down,
        (event) => {
          const [x, y] = spotOf(plan, event);
          const isFar = Math.hypot(x - startX, y - startY) >= SLACK_PX;
          if (!held && !(isFar && mayBegin())) return;
          held ??= grip();
          const { sheet, own } = held;
          moveTo(fromSheet(sheet, [own[0] + x - startX, own[1] + y - startY]));
        },
        ({ type }) => void moves.end(type === "pointerup"),
      );
      moves.follow(unfollow);
    },
    onKeyDown: (event) => {
      const arrow = arrowOf(event.key);
      if (event.key === "Escape" && moves.isTaken) void moves.end(false);
      else if (!arrow || event.ctrlKey || event.metaKey || event.altKey || !mayMove()) return;
      else if (mayBegin()) {
        const { sheet, own } = grip();
        const px = (event.shiftKey ? 10 : 1) * props.stepM * sheet.pxPerM;
        moveTo(fromSheet(sheet, [own[0] + arrow[0] * px, own[1] + arrow[1] * px]));
      }
      event.preventDefault();
    },
    onKeyUp: ({ key }) => {
      if (arrowOf(key)) void moves.end(true);
    },
    onBlur: () => void moves.end(true),
  };
}
