/** Scales that values are changed in: distances in their inverse, as a focus ring turns, and f-numbers and the like in stops. */

import { FAR_AWAY_M } from "./changes";
import {
  isSameOwner,
  isPlain,
  mapKeys,
  sliderOf,
  valued,
  type KeyOwner,
  type KeyStack,
  type OwnedKey,
} from "./key_lanes";

export interface ValueScale {
  readonly to: (value: number) => number;
  readonly from: (scaled: number) => number;
  /** Change of `to` for a small change of the value. */
  readonly slope: (value: number) => number;
}

const PLAIN: ValueScale = { to: (value) => value, from: (value) => value, slope: () => 1 };
const STOPS: ValueScale = { to: Math.log, from: Math.exp, slope: (value) => 1 / value };
const RING: ValueScale = {
  to: (value) => 1 / value,
  from: (w) => 1 / Math.max(w, 1 / FAR_AWAY_M),
  slope: (value) => -1 / (value * value),
};

/** The scale of a setting or attribute; the plain one where some of the values are not above 0. */
export function valueScaleOf(owner: KeyOwner, values: readonly number[]): ValueScale {
  const scale = sliderOf(owner)?.scale ?? "linear";
  if (scale === "linear" || values.some((value) => value <= 0)) return PLAIN;
  return scale === "ring" ? RING : STOPS;
}

/** The lowest and the highest value of keys. */
export interface ValueSpan {
  readonly owner: KeyOwner;
  readonly least: number;
  readonly most: number;
}

/** The span of values that stacks have; null where they are not several keys of one setting or attribute. */
export function valueSpanOf(stacks: readonly KeyStack[]): ValueSpan | null {
  const owned = stacks.flatMap(({ keys }) => keys);
  const [first] = owned;
  const isOne = owned.every(({ owner }) => first && isSameOwner(owner, first.owner));
  if (!first || owned.length < 2 || !isOne || isPlain(first.owner)) return null;
  const values = owned.map(({ key }) => key.value);
  return { owner: first.owner, least: Math.min(...values), most: Math.max(...values) };
}

/**
 * Stacks whose values are spread from one to another, in the scale of their setting, with the slopes of their handles. Keys that
 * all have one value get the end that is new. Stacks of several curves stay as they are.
 */
export function respanned(stacks: readonly KeyStack[], one: number, other: number): readonly KeyStack[] {
  const before = valueSpanOf(stacks);
  if (!before) return stacks;
  const after = { least: Math.min(one, other), most: Math.max(one, other) };
  const { to, from, slope } = valueScaleOf(before.owner, [before.least, before.most, after.least, after.most]);
  const [least, most] = [to(before.least), to(before.most)];
  const factor = most === least ? 0 : (to(after.most) - to(after.least)) / (most - least);
  const flat = after.most === before.most ? after.least : after.most;
  const spread = (value: number): number => {
    if (most === least) return flat;
    if (value === before.least) return after.least;
    return value === before.most ? after.most : from(to(after.least) + (to(value) - least) * factor);
  };
  return mapKeys(stacks, (owned): OwnedKey => {
    const { owner, key } = valued(owned, spread(owned.key.value));
    const { tangents } = key;
    if (!tangents) return { owner, key };
    const turn = (steep = 0): number => (slope(owned.key.value) * steep * factor) / slope(key.value);
    return {
      owner,
      key: { ...key, tangents: { ...tangents, inSlope: turn(tangents.inSlope), outSlope: turn(tangents.outSlope) } },
    };
  });
}
