/** Scales that values are changed in: distances in their inverse, as a focus ring turns, and f-numbers and the like in stops. */

import { FAR_AWAY_M } from "./changes";
import { sliderOf, type KeyOwner } from "./key_lanes";

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
