/** Keys of values over time. */

import type { components } from "../net/schema";

/** `auto` eases in and out of its neighbours without overshooting them. */
export type Interpolation = "held" | "linear" | "bezier" | "auto";

/** Handles of a `bezier` key: slopes in the value's unit for each time code, and how far they reach, time codes. */
export type Tangents = components["schemas"]["Tangents"];

export interface Key {
  /** USD time code. */
  readonly time: number;
  readonly value: number;
  readonly interpolation: Interpolation;
  /** Of a `bezier` key; left out, those that an `auto` key would have. */
  readonly tangents?: Tangents;
}

/** Keys of settings by their names; a setting without keys is not in it. */
export type Keyed = Readonly<Record<string, readonly Key[]>>;

/** A setting of the camera that takes keys, by its name over REST. */
export type KeyedSetting = components["schemas"]["KeySetting"]["setting"];
