/** Where the graph of a value draws. */

import type { KeyOwner } from "../../model/key_lanes";
import type { Side } from "../../model/spline";
import type { ValueAxis } from "../../model/value_curves";
import type { TimeAxis } from "./time_axis";

/** Places in CSS px. */
export interface Plot {
  readonly time: TimeAxis;
  readonly axis: ValueAxis;
  readonly height: number;
  readonly x: (time: number) => number;
  readonly y: (value: number) => number;
}

export const SIDES: readonly Side[] = ["in", "out"];

export function isDistance(owner: KeyOwner): boolean {
  return "setting" in owner && owner.setting === "focusDistanceM";
}
