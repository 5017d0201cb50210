/** Corrections of a dense curve, such as an imported or recorded one: a value that is wanted at a frame bends the curve around it. */

import { FAR_AWAY_M, type Changes } from "./changes";
import { heldIn, setKey, type ValueOwner } from "./key_lanes";
import type { Key } from "./keys";
import { valueAt } from "./spline";
import { sameTime } from "./time";
import { valueScaleOf, type ValueScale } from "./value_scale";

export interface Correction {
  /** What has the curve. */
  readonly owner: ValueOwner;
  /** The curve before it. */
  readonly keys: readonly Key[];
  /** USD time code. */
  readonly time: number;
  /** The value that the curve is to have there. */
  readonly value: number;
}

/** Most frames to each side. */
export const MOST_BENT = 100;
/** Most keys that are bent, which an edit has room for twice: where they were, and where they are. */
const MOST_KEYS = 120;
/** How near the keys on both sides of a dense curve's frame are, frames. */
const DENSE = 2.5;
const MANY = 4;

/** Whether a key at this time alone would make a spike: the curve has keys close to it on both sides. */
export function isDense(keys: readonly Key[], time: number): boolean {
  const others = keys.filter((key) => !sameTime(key.time, time));
  const reached = (side: number, reach: number): number =>
    others.filter((key) => (key.time - time) * side > 0 && Math.abs(key.time - time) <= reach).length;
  const [before, after] = [reached(-1, DENSE), reached(1, DENSE)];
  if (before > 0 && after > 0) return true;
  // At an end of the curve, several on the other side say so.
  return [-1, 1].some((side) => reached(side, 2 * DENSE) >= MANY && reached(-side, Infinity) === 0);
}

/** Bends a dense curve to a value: most where it is wanted, and less and less up to `width` frames before and after. */
export function correct(correction: Correction, width: number): Changes {
  return toChanges(correction.owner, bent(correction, width));
}

/** Bends a curve that a correction has bent already, as if that one had been of another width. */
export function recorrect(correction: Correction, before: number, width: number): Changes {
  const wanted = bent(correction, width);
  const old = bent(correction, before).flatMap(
    ({ time }) => correction.keys.find((key) => sameTime(key.time, time)) ?? [],
  );
  const restored = old.filter(({ time }) => !wanted.some((key) => sameTime(key.time, time)));
  return toChanges(correction.owner, [...restored, ...wanted]);
}

function toChanges(owner: ValueOwner, keys: readonly Key[]): Changes {
  return keys.toSorted((a, b) => a.time - b.time).map((key) => setKey(owner, key));
}

/** The keys that a correction sets. */
function bent({ owner, keys, time, value }: Correction, width: number): Key[] {
  const scale = valueScaleOf(owner, [...keys.map((key) => key.value), value]);
  const wanted = "setting" in owner && owner.setting === "focusDistanceM" ? Math.min(value, FAR_AWAY_M) : value;
  const by = scale.to(wanted) - scale.to(valueAt(keys, time) ?? wanted);
  const others = keys.filter((key) => !sameTime(key.time, time));
  const farthest = others.map((key) => Math.abs(key.time - time)).toSorted((a, b) => a - b)[MOST_KEYS];
  const reach = Math.min(width, farthest ?? width);
  const near = others.filter((key) => Math.abs(key.time - time) < reach);
  const own = keys.find((key) => sameTime(key.time, time));
  const before = keys.findLast((key) => key.time < time);
  const at: Key = own ? { ...own, value: wanted } : { time, value: wanted, interpolation: shapeAfter(before) };
  return [...near.map((key) => bendKey(key, (key.time - time) / reach, by, reach, scale, owner)), at];
}

/** A new key's interpolation after another one: a copy of its handles would not fit. */
function shapeAfter(key: Key | undefined): Key["interpolation"] {
  return key === undefined || key.interpolation === "bezier" ? "auto" : key.interpolation;
}

/**
 * @param u place of the key from -1 to 1 over the width of the correction.
 * @param by the correction at its middle, in the scale.
 */
function bendKey(key: Key, u: number, by: number, width: number, scale: ValueScale, owner: ValueOwner): Key {
  const [share, turn] = [(1 - u * u) ** 2, (-4 * u * (1 - u * u)) / width];
  const bentTo = scale.from(scale.to(key.value) + by * share);
  const value = heldIn(owner, bentTo);
  const { tangents } = key;
  if (value !== bentTo && tangents) return { ...key, value, tangents: { ...tangents, inSlope: 0, outSlope: 0 } };
  if (key.interpolation !== "bezier" || !tangents) return { ...key, value };
  const slope = (before = 0): number => (scale.slope(key.value) * before + by * turn) / scale.slope(value);
  return {
    ...key,
    value,
    tangents: { ...tangents, inSlope: slope(tangents.inSlope), outSlope: slope(tangents.outSlope) },
  };
}
