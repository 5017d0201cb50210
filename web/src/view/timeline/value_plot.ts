/** Where the graph of a value draws, and how the value is written. */

import { FAR_AWAY_M } from "../../model/changes";
import { formatDistance, type LengthUnit } from "../../model/distance";
import type { KeyOwner } from "../../model/key_lanes";
import type { Side } from "../../model/spline";
import type { ValueAxis } from "../../model/value_curves";
import { trim } from "../numbers";
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

/** A value as it is written: a distance in the unit of the page, and one far away as infinity. */
export function formatValue(owner: KeyOwner, value: number, unit: LengthUnit): string {
  return isDistance(owner) ? formatDistance(value < FAR_AWAY_M ? value : Infinity, unit) : trim(value, 3);
}
