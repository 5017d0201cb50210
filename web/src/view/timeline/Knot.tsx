/** A key on its curve, with the handles that it has while it is selected. */

import type { JSX, RefObject } from "preact";
import { useRef } from "preact/hooks";
import type { KeyShift } from "../../editor/key_drag";
import type { Session } from "../../editor/session";
import { FAR_AWAY_M } from "../../model/changes";
import { sampleAt } from "../../model/curve";
import type { LengthUnit } from "../../model/distance";
import { sliderOf, stackId, type KeyOwner } from "../../model/key_lanes";
import type { Key } from "../../model/keys";
import { scaleOf } from "../../model/scale";
import { handleAt, tangentsAt, type Place, type Side } from "../../model/spline";
import { formatFrame } from "../../model/time";
import {
  exchange,
  raise,
  raisedValue,
  snapTargets,
  withHandle,
  type CurveKey,
  type ValueCurve,
} from "../../model/value_curves";
import { trim } from "../numbers";
import { SNAP_PX, useKeyGestures, type KeyGestures, type Way } from "./key_gestures";
import { formatValue, handlePlace, isDistance, SIDES, type Plot } from "./value_plot";

interface KnotProps {
  readonly session: Session;
  readonly plot: Plot;
  readonly curve: ValueCurve;
  /** Its keys. */
  readonly keys: readonly Key[];
  readonly index: number;
}

/** Gestures on the key of a curve. */
function useKnotGestures(
  session: Session,
  plot: Plot,
  curve: ValueCurve,
  entry: CurveKey,
  button: RefObject<HTMLButtonElement | null>,
): KeyGestures {
  const { keys, playhead } = session;
  const { stack } = entry;
  return useKeyGestures(session, {
    stack,
    isRaised: true,
    dragged: (way) => dragged(session, plot, curve, entry, way),
    nudged: ({ right, down }) => ({
      by: right,
      reach: null,
      reshape: raise(curve, (value) => stepped(curve.owner, value, -down)),
    }),
    click: (adds) => {
      keys.select([stack], adds);
      if (!adds) playhead.goTo(keys.shownAs(stack).time);
    },
    arrived: (at) => {
      const isOnKnot = document.activeElement?.matches("[data-knot]") ?? false;
      if (isOnKnot || document.activeElement === document.body)
        button.current
          ?.closest(".graph")
          ?.querySelector<HTMLElement>(`[data-knot="${CSS.escape(stackId(stack.lane, at))}"]`)
          ?.focus();
    },
  });
}

export function Knot({
  session,
  plot,
  curve,
  keys,
  index,
  entry,
  unit,
  withHandles,
}: KnotProps & { entry: CurveKey; unit: LengthUnit; withHandles: boolean }): JSX.Element {
  const { playhead } = session;
  const {
    stack,
    owned: { key },
  } = entry;
  const button = useRef<HTMLButtonElement>(null);
  const isSelected = session.keys.selected.value.has(stack.id);
  const gestures = useKnotGestures(session, plot, curve, entry, button);
  const says = `${formatValue(curve.owner, key.value, unit)}, ${key.interpolation}`;
  return (
    <>
      <button
        type="button"
        ref={button}
        data-knot={stack.id}
        class={`knot${isSelected ? " selected" : ""}${plot.time.has(key.time) ? "" : " out"}`}
        style={{ left: `${plot.x(key.time)}px`, top: `${plot.y(key.value)}px` }}
        aria-pressed={isSelected}
        aria-label={`${curve.label} at frame ${formatFrame(key.time)}: ${says}`}
        title={`${formatFrame(key.time)}: ${says}`}
        {...handlersOf(gestures)}
        onClick={(event) => {
          if (event.detail > 0) return; // a pointer's, which `useKeyGestures` sees
          session.keys.select([stack], event.shiftKey);
          if (!event.shiftKey) playhead.goTo(key.time);
        }}
      />
      {isSelected &&
        withHandles &&
        SIDES.map((side) => (
          <Handle key={side} session={session} plot={plot} curve={curve} keys={keys} index={index} side={side} />
        ))}
    </>
  );
}

/** The end of a handle; none where the key or the curve beside it is not curved. */
function Handle({ session, plot, curve, keys, index, side }: KnotProps & { side: Side }): JSX.Element | null {
  const entry = curve.keys[index];
  const end = handleAt(keys, index, side);
  const moved = (to: Place, isBroken: boolean): KeyShift => {
    const changed = withHandle(curve, index, side, to, isBroken);
    return { by: 0, reach: null, ...(changed && { reshape: exchange(curve, changed) }) };
  };
  const gestures = useKeyGestures(session, {
    stack: entry?.stack ?? { id: "", lane: "", time: 0, keys: [] },
    isRaised: true,
    dragged: ({ right, down, isFree }) =>
      moved(endAt(plot, end, right / plot.time.perFrame, -down / plot.height), isFree),
    nudged: ({ right, down }) => moved(endAt(plot, end, right, -down * HANDLE_STEP), false),
    click: () => undefined, // not a key, which Shift would add to the selection
    arrived: () => undefined,
  });
  if (!entry || !end) return null;
  const { key } = entry.owned;
  const { [side === "in" ? "inSlope" : "outSlope"]: slope } = tangentsAt(keys, index);
  const name = side === "in" ? "before" : "after";
  const length = formatFrame(Math.abs(end.time - key.time));
  const { x, y } = handlePlace(plot, key, end, side);
  return (
    <button
      type="button"
      class={x >= plot.time.left && x <= plot.time.right ? "handle" : "handle out"}
      data-handle={side}
      style={{ left: `${x}px`, top: `${y}px` }}
      aria-label={`Handle ${name} frame ${formatFrame(key.time)}: slope ${trim(slope, 4)} a frame, ${length} frames long`}
      title={`Slope ${trim(slope, 4)} a frame, ${length} frames long; Alt moves this handle alone`}
      {...handlersOf(gestures)}
    />
  );
}

/** The handlers of a key or handle: what it takes does not scrub, and does nothing else on the page. */
function handlersOf({ onPointerDown, onKeyDown, onKeyUp, onBlur }: KeyGestures): KeyHandlers {
  return {
    onPointerDown: (event) => {
      event.stopPropagation();
      onPointerDown(event);
    },
    onKeyDown: (event) => {
      if (onKeyDown(event)) event.preventDefault();
    },
    onKeyUp,
    onBlur,
  };
}

type KeyHandlers = Pick<KeyGestures, "onPointerDown" | "onKeyUp" | "onBlur"> & {
  readonly onKeyDown: (event: KeyboardEvent) => void;
};

/** Share of the axis that an arrow key moves the end of a handle by. */
const HANDLE_STEP = 0.02;

/** The end of a handle so many frames later, and so much of the axis higher. */
function endAt(plot: Plot, end: Place | null, frames: number, up: number): Place {
  const { time, value } = end ?? { time: 0, value: 0 };
  const raised = up === 0 ? value : plot.axis.value(plot.axis.fraction(value) + up);
  // A handle does not go to infinity.
  return { time: time + frames, value: raised >= FAR_AWAY_M ? value : raised };
}

/** What a pointer makes of the selected keys: the one under it snaps, and those of the same curve go up and down with it. */
function dragged(session: Session, plot: Plot, curve: ValueCurve, { owned }: CurveKey, way: Way): KeyShift {
  const isAcross = Math.abs(way.right) >= Math.abs(way.down);
  const [right, down] = way.isStraight ? (isAcross ? [way.right, 0] : [0, way.down]) : [way.right, way.down];
  const { axis, height } = plot;
  const { key } = owned;
  const by = right / plot.time.perFrame;
  const depths = isDistance(curve.owner) ? depthsAt(session, key.time + by) : [];
  const reach = way.isFree ? null : SNAP_PX / height;
  const value = raisedValue(axis, key.value, -down / height, snapTargets(curve, axis, depths), reach);
  const up = axis.fraction(value) - axis.fraction(key.value);
  const change = (other: number): number => (other === key.value ? value : raisedValue(axis, other, up, [], null));
  return { by, reach: way.isFree ? null : SNAP_PX / plot.time.perFrame, reshape: raise(curve, change) };
}

/** Depths of the focus points, m. */
function depthsAt(session: Session, time: number): number[] {
  const sample = sampleAt(session.document.curve.peek(), time);
  return (sample?.points ?? []).flatMap(({ depthM }) => (depthM !== null && depthM > 0 ? [depthM] : []));
}

/** A value so many steps of its slider away. */
function stepped(owner: KeyOwner, value: number, count: number): number {
  if (count === 0) return value;
  const slider = sliderOf(owner);
  return slider ? scaleOf(slider).step(value, count) : value + count * 0.01 * Math.max(1, Math.abs(value));
}
