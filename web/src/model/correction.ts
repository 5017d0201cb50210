/** Corrections of a dense curve, such as an imported or recorded one: a value that is wanted at a frame bends the curve around it. */

import { FAR_AWAY_M, type Changes } from "./changes";
import { sliderOf } from "./key_lanes";
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
  return toChanges(correction.setting, bent(correction, width));
}

/** Bends a curve that a correction has bent already, as if that one had been of another width. */
export function recorrect(correction: Correction, before: number, width: number): Changes {
  const wanted = bent(correction, width);
  const old = bent(correction, before).flatMap(
    ({ time }) => correction.keys.find((key) => sameTime(key.time, time)) ?? [],
  );
  const restored = old.filter(({ time }) => !wanted.some((key) => sameTime(key.time, time)));
  return toChanges(correction.setting, [...restored, ...wanted]);
}

function toChanges(setting: KeyedSetting, keys: readonly Key[]): Changes {
  return keys.toSorted((a, b) => a.time - b.time).map((key): Changes[number] => ({ type: "keySetting", setting, key }));
}

/** The keys that a correction sets. */
function bent({ setting, keys, time, value }: Correction, width: number): Key[] {
  const scale = scaleOf(setting, [...keys.map((key) => key.value), value]);
  const wanted = setting === "focusDistanceM" ? Math.min(value, FAR_AWAY_M) : value;
  const by = scale.to(wanted) - scale.to(valueAt(keys, time) ?? wanted);
  const others = keys.filter((key) => !sameTime(key.time, time));
  const farthest = others.map((key) => Math.abs(key.time - time)).toSorted((a, b) => a - b)[MOST_KEYS];
  const reach = Math.min(width, farthest ?? width);
  const near = others.filter((key) => Math.abs(key.time - time) < reach);
  const own = keys.find((key) => sameTime(key.time, time));
  const before = keys.findLast((key) => key.time < time);
  const at: Key = own ? { ...own, value: wanted } : { time, value: wanted, interpolation: shapeAfter(before) };
  return [...near.map((key) => bendKey(key, (key.time - time) / reach, by, reach, scale)), at];
}

/** A new key's interpolation after another one: a copy of its handles would not fit. */
function shapeAfter(key: Key | undefined): Key["interpolation"] {
  return key === undefined || key.interpolation === "bezier" ? "auto" : key.interpolation;
}

/** What a value is bent in: distances in their inverse, as a focus ring turns, and f-numbers and the like in stops. */
interface BendScale {
  readonly to: (value: number) => number;
  readonly from: (bent: number) => number;
  /** Change of `to` for a small change of the value. */
  readonly slope: (value: number) => number;
}

const PLAIN: BendScale = { to: (value) => value, from: (value) => value, slope: () => 1 };
const STOPS: BendScale = { to: Math.log, from: Math.exp, slope: (value) => 1 / value };
const RING: BendScale = {
  to: (value) => 1 / value,
  from: (w) => 1 / Math.max(w, 1 / FAR_AWAY_M),
  slope: (value) => -1 / (value * value),
};

function scaleOf(setting: KeyedSetting, values: readonly number[]): BendScale {
  const scale = sliderOf({ setting })?.scale ?? "linear";
  if (scale === "linear" || values.some((value) => value <= 0)) return PLAIN;
  return scale === "ring" ? RING : STOPS;
}

/**
 * @param u place of the key from -1 to 1 over the width of the correction.
 * @param by the correction at its middle, in the scale.
 */
function bendKey(key: Key, u: number, by: number, width: number, scale: BendScale): Key {
  const [share, turn] = [(1 - u * u) ** 2, (-4 * u * (1 - u * u)) / width];
  const value = scale.from(scale.to(key.value) + by * share);
  const { tangents } = key;
  if (key.interpolation !== "bezier" || !tangents) return { ...key, value };
  const slope = (before = 0): number => (scale.slope(key.value) * before + by * turn) / scale.slope(value);
  return {
    ...key,
    value,
    tangents: { ...tangents, inSlope: slope(tangents.inSlope), outSlope: slope(tangents.outSlope) },
  };
}
