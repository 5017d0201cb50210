/** Corrections of a dense curve, such as an imported or recorded one: a value that is wanted at a frame bends the curve around it. */

import { FAR_AWAY_M, type Changes } from "./changes";
import { inverse } from "./distance";
import type { Key, KeyedSetting } from "./keys";
import { valueAt } from "./spline";
import { sameTime } from "./time";

export interface Correction {
  readonly setting: KeyedSetting;
  /** The curve before it. */
  readonly keys: readonly Key[];
  /** USD time code. */
  readonly time: number;
  /** The value that the curve is to have there. */
  readonly value: number;
}

/** Most frames to each side: each key in them is a change of the edit. */
export const MOST_BENT = 100;

/** How near the keys on both sides of a dense curve's frame are, frames. */
const DENSE = 2.5;

/** Whether a key at this time alone would make a spike: the curve has keys close to it on both sides. */
export function isDense(keys: readonly Key[], time: number): boolean {
  const others = keys.filter((key) => !sameTime(key.time, time));
  const isNear = (side: number): boolean =>
    others.some((key) => (key.time - time) * side > 0 && Math.abs(key.time - time) <= DENSE);
  return isNear(-1) && isNear(1);
}

/**
 * Bends a dense curve to a value: most where it is wanted, and less and less up to `width` frames before and after. Distances are
 * bent as a focus ring turns, in their inverse.
 */
export function correct({ setting, keys, time, value }: Correction, width: number): Changes {
  const ring = setting === "focusDistanceM";
  const wanted = ring ? Math.min(value, FAR_AWAY_M) : value;
  const to = ring ? inverse : same;
  const by = to(wanted) - to(valueAt(keys, time) ?? wanted);
  const bent = keys
    .filter((key) => Math.abs(key.time - time) < width && !sameTime(key.time, time))
    .map((key) => bendKey(key, (key.time - time) / width, by, width, ring));
  const own = keys.find((key) => sameTime(key.time, time)) ?? keys.findLast((key) => key.time < time);
  const at: Key =
    own && sameTime(own.time, time)
      ? { ...own, value: wanted }
      : { time, value: wanted, interpolation: shapeAfter(own) };
  return [...bent, at]
    .toSorted((a, b) => a.time - b.time)
    .map((key): Changes[number] => ({ type: "keySetting", setting, key }));
}

/** A new key's interpolation after another one: a copy of its handles would not fit. */
function shapeAfter(key: Key | undefined): Key["interpolation"] {
  return key === undefined || key.interpolation === "bezier" ? "auto" : key.interpolation;
}

function same(value: number): number {
  return value;
}

/**
 * @param u place of the key from -1 to 1 over the width of the correction.
 * @param by the correction at its middle, in the inverse of distances.
 */
function bendKey(key: Key, u: number, by: number, width: number, ring: boolean): Key {
  const [share, turn] = [(1 - u * u) ** 2, (-4 * u * (1 - u * u)) / width];
  const value = ring ? 1 / Math.max(1 / key.value + by * share, 1 / FAR_AWAY_M) : key.value + by * share;
  const { tangents } = key;
  if (key.interpolation !== "bezier" || !tangents) return { ...key, value };
  const slope = (before = 0): number =>
    ring ? value * value * (before / (key.value * key.value) - by * turn) : before + by * turn;
  return {
    ...key,
    value,
    tangents: { ...tangents, inSlope: slope(tangents.inSlope), outSlope: slope(tangents.outSlope) },
  };
}
