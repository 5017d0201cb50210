/** Keyed values as curves: which there are, the axis that each is drawn on, and what a drag of a key or a handle makes of it. */

import { FAR_AWAY_M } from "./changes";
import { axisFraction, distanceAxis, formatMark, inverse, type LengthUnit } from "./distance";
import {
  hasValue,
  isSameOwner,
  isPlain,
  labelOf,
  sliderOf,
  valued,
  withTangents,
  type KeyLane,
  type KeyOwner,
  type KeyStack,
  type OwnedKey,
  type ValueOwner,
} from "./key_lanes";
import type { Key } from "./keys";
import type { SliderRange } from "./settings.gen";
import { handleAt, tangentsAt, type Place, type Side } from "./spline";
import { sameTime } from "./time";

/** A key of a curve, and the stack of its lane that it is moved with. */
export interface CurveKey {
  readonly stack: KeyStack;
  /** Its number among the keys of the curve as the service has them. */
  readonly place: number;
  /** As it is shown. */
  readonly owned: OwnedKey;
}

export interface ValueCurve {
  readonly id: string;
  readonly label: string;
  readonly owner: ValueOwner;
  /** In the order of the time at which they are shown. */
  readonly keys: readonly CurveKey[];
}

/**
 * The curves of lanes, in their order; switches and places have none.
 *
 * @param shownAs a stack as it is shown; by default as it is.
 */
export function curvesOf(
  lanes: readonly KeyLane[],
  shownAs: (stack: KeyStack) => KeyStack = (stack) => stack,
): ValueCurve[] {
  return lanes.flatMap((lane) => {
    const shown = lane.stacks.map((stack) => ({ stack, keys: shownAs(stack).keys }));
    const owners = new Map(
      lane.stacks.flatMap(({ keys }) => keys.filter(hasValue).map(({ owner }) => [nameOf(owner), owner] as const)),
    );
    return [...owners]
      .filter(([, owner]) => !isPlain(owner))
      .map(([name, owner]): ValueCurve => {
        const label = lane.point === null ? lane.label : `${lane.label}: ${labelOf(owner)}`;
        const keys = shown
          .flatMap(({ stack, keys }) =>
            keys.filter((owned) => nameOf(owned.owner) === name).map((owned) => ({ stack, owned })),
          )
          .map((key, place): CurveKey => ({ ...key, place }));
        return { id: `${lane.id} ${name}`, label, owner, keys: withoutReplaced(keys) };
      });
  });
}

function nameOf(owner: KeyOwner): string {
  if ("place" in owner) return "place";
  return "setting" in owner ? owner.setting : owner.attribute;
}

/** Keys in the order of time; of two at one time the one that was moved, which stands in the place of the other. */
function withoutReplaced(keys: readonly CurveKey[]): CurveKey[] {
  const isMoved = ({ stack, owned }: CurveKey): boolean => owned.key.time !== stack.time;
  const kept: CurveKey[] = [];
  for (const key of keys.toSorted((a, b) => a.owned.key.time - b.owned.key.time)) {
    const last = kept.at(-1);
    if (!last || !sameTime(last.owned.key.time, key.owned.key.time)) kept.push(key);
    else if (isMoved(key) || !isMoved(last)) kept[kept.length - 1] = key;
  }
  return kept;
}

/** The keys of a curve as a spline has them. */
export function keysOfCurve(curve: ValueCurve): Key[] {
  return curve.keys.map(({ owned }) => owned.key);
}

/** A vertical axis: linear, logarithmic for what is counted in stops, reciprocal for distances. */
export interface ValueAxis {
  /** Where a value stands: 0 at the foot, 1 at the top. */
  readonly fraction: (value: number) => number;
  /** The value at a fraction. */
  readonly value: (fraction: number) => number;
  /** Values to label. */
  readonly ticks: readonly { readonly value: number; readonly label: string }[];
}

/** Share of an axis that is free above and below its values. */
const AIR = 0.12;
/** Distances that a ring's axis tells apart, m. */
const [NEAREST_M, FARTHEST_M] = [0.01, 1000];
/** F-numbers in thirds of a stop. */
const THIRDS = Array.from({ length: 40 }, (_, third) => 2 ** (third / 6 - 1));

/**
 * An axis that holds all keys of a curve and the ends of their handles, with some air around them.
 *
 * @param curve as the service has it, so that the axis stays as it is while keys are dragged.
 * @param more values that it holds too.
 * @param mostTicks labels that there is room for.
 * @param keyed values that the curve has, by default those of all its keys.
 */
export function valueAxis(
  curve: ValueCurve,
  more: readonly number[],
  unit: LengthUnit,
  mostTicks: number,
  keyed: readonly number[] = curve.keys.map(({ owned }) => owned.key.value),
): ValueAxis {
  const slider = sliderOf(curve.owner);
  const isShare = slider?.scale === "linear" && slider.most - slider.least <= 1;
  const values = [
    ...keyed,
    ...more.map((value) => held(value, keyed, slider)),
    ...(isShare ? [slider.least, slider.most] : []),
  ];
  if (slider?.scale === "ring") {
    const axis = distanceAxis(
      values.map((value) => (value === 0 ? Infinity : value)),
      unit,
      mostTicks,
    );
    const span = axis.nearW - axis.farW;
    return {
      fraction: (value) => axisFraction(axis, value === 0 ? Infinity : Math.max(value, NEAREST_M)),
      value: (fraction) => {
        const w = axis.nearW - fraction * span;
        return w <= inverse(FARTHEST_M) ? FAR_AWAY_M : 1 / w;
      },
      ticks: axis.ticks.map((tick) => ({ value: tick, label: formatMark(tick, unit) })),
    };
  }
  const isLog = slider !== null && slider.scale !== "linear" && values.every((value) => value > 0);
  const [to, from] = isLog ? [Math.log2, (x: number): number => 2 ** x] : [same, same];
  const [low, high] = [Math.min(...values.map(to)), Math.max(...values.map(to))];
  const least = isLog ? 0.5 : slider ? (slider.most - slider.least) / 10 : Math.max(Math.abs(high) / 10, 1e-3);
  const span = Math.max(high - low, least) * (1 + 2 * AIR);
  const foot = (low + high - span) / 2;
  const ticks = isLog ? stopTicks(from(foot), from(foot + span), mostTicks) : linearTicks(foot, foot + span, mostTicks);
  return {
    fraction: (value) => (to(isLog ? Math.max(value, 1e-9) : value) - foot) / span,
    value: (fraction) => from(foot + fraction * span),
    ticks: ticks.map((value) => ({ value, label: Number(value.toPrecision(3)).toString() })),
  };
}

function same(value: number): number {
  return value;
}

/** A value that an axis holds too, but not farther from the keys than they are from each other. */
function held(value: number, keyed: readonly number[], slider: SliderRange | null): number {
  const [low, high] = [Math.min(...keyed), Math.max(...keyed)];
  const room = Math.max(high - low, slider?.scale === "linear" ? (slider.most - slider.least) / 4 : high / 2);
  return Math.min(Math.max(value, low - room), high + room);
}

/** Round values at a step of 1, 2 or 5. */
function linearTicks(low: number, high: number, most: number): number[] {
  const rough = (high - low) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = ([1, 2, 5, 10].find((times) => times * power >= rough) ?? 10) * power;
  const count = Math.floor(high / step) - Math.ceil(low / step) + 1;
  return Array.from({ length: Math.max(0, count) }, (_, place) =>
    Number(((Math.ceil(low / step) + place) * step).toPrecision(9)),
  );
}

/** Stops of an f-number, a factor of √2 apart: thirds of them where there is room, several where there is little. */
function stopTicks(low: number, high: number, most: number): number[] {
  const [first, last] = [Math.log2(low), Math.log2(high)];
  const step = [1 / 6, 0.5, 1, 2, 4].find((stops) => (last - first) / stops <= most) ?? 8;
  const from = Math.ceil(first / step);
  return Array.from(
    { length: Math.max(0, Math.floor(last / step) - from + 1) },
    (_, place) => 2 ** ((from + place) * step),
  );
}

/** Values that a dragged key snaps to: the marks of the axis, third stops of an f-number, and what else is given. */
export function snapTargets(curve: ValueCurve, axis: ValueAxis, more: readonly number[]): number[] {
  const isStop = "setting" in curve.owner && /FStop$|^fStop$/.test(curve.owner.setting);
  return [...axis.ticks.map(({ value }) => value), ...(isStop ? THIRDS : []), ...more];
}

/**
 * A key that is dragged up or down an axis.
 *
 * @param by fraction of the axis.
 * @param targets values to snap to.
 * @param reach how near one must be, as a fraction of the axis; null does not snap.
 */
export function raisedValue(
  axis: ValueAxis,
  value: number,
  by: number,
  targets: readonly number[],
  reach: number | null,
): number {
  if (by === 0) return value;
  const wanted = axis.fraction(value) + by;
  const near = targets
    .map((target) => ({ target, off: Math.abs(axis.fraction(target) - wanted) }))
    .filter(({ off }) => reach !== null && off <= reach)
    .toSorted((a, b) => a.off - b.off);
  return near[0]?.target ?? Number(axis.value(wanted).toPrecision(5));
}

/** A value held within what its slider has, unless it was beyond that already. */
export function heldValue(owner: KeyOwner, before: number, value: number): number {
  const slider = sliderOf(owner);
  if (!slider) return value;
  const most = slider.scale === "ring" ? FAR_AWAY_M : slider.most;
  return Math.min(Math.max(value, Math.min(slider.least, before)), Math.max(most, before));
}

/** Keys of a curve that are raised, and others as they are; for `KeyShift`. */
export function raise(curve: ValueCurve, change: (value: number) => number): (owned: OwnedKey) => OwnedKey {
  return (owned) =>
    isSameOwner(curve.owner, owned.owner)
      ? valued(owned, heldValue(curve.owner, owned.key.value, change(owned.key.value)))
      : owned;
}

/** Shortest handle, time codes: one of no width is as long as a third of the segment. */
const SHORTEST = 0.05;

/**
 * A key one of whose handles ends elsewhere. It stays on its side and within the segment. The other handle keeps its length, and
 * its slope follows unless it has had another one.
 *
 * @param index of the key in the curve.
 * @param isBroken whether the other handle keeps its slope.
 */
export function withHandle(
  curve: ValueCurve,
  index: number,
  side: Side,
  end: Place,
  isBroken: boolean,
): OwnedKey | null {
  const keys = keysOfCurve(curve);
  const [at, other] = [curve.keys[index], keys[side === "in" ? index - 1 : index + 1]];
  if (!at || !other) return null;
  const { key } = at.owned;
  const longest = Math.abs(other.time - key.time);
  const away = side === "in" ? key.time - end.time : end.time - key.time;
  const width = Math.min(Math.max(away, SHORTEST), longest);
  const rise = side === "in" ? key.value - end.value : end.value - key.value;
  const before = tangentsAt(keys, index);
  const joined = !isBroken && Math.abs(before.inSlope - before.outSlope) < 1e-9;
  const wanted = Number((rise / width).toPrecision(6));
  const room = roomBelow(curve.owner, key.value);
  // Where neither handle ends below what the setting may be, the curve does not go there.
  const outWidth = side === "out" ? width : joined && handleAt(keys, index, "out") ? before.outWidth : 0;
  const inWidth = side === "in" ? width : joined && handleAt(keys, index, "in") ? before.inWidth : 0;
  const slope = Math.min(
    Math.max(wanted, outWidth > 0 ? -room / outWidth : -Infinity),
    inWidth > 0 ? room / inWidth : Infinity,
  );
  const [own, opposite] = [Number(width.toFixed(3)), joined ? slope : null];
  return withTangents(
    at.owned,
    side === "in"
      ? { ...before, inSlope: slope, inWidth: own, outSlope: opposite ?? before.outSlope }
      : { ...before, outSlope: slope, outWidth: own, inSlope: opposite ?? before.inSlope },
  );
}

/** How far a curve may go below a key; infinite for a setting that may be negative. */
function roomBelow(owner: KeyOwner, value: number): number {
  const least = sliderOf(owner)?.least ?? -Infinity;
  return least >= 0 ? (value - Math.min(least, value)) * 0.999 : Infinity;
}

/** Puts a key in place of the same one; for `KeyShift`. */
export function exchange(curve: ValueCurve, changed: OwnedKey): (owned: OwnedKey) => OwnedKey {
  return (owned) => (isSameOwner(curve.owner, owned.owner) && owned.key.time === changed.key.time ? changed : owned);
}
