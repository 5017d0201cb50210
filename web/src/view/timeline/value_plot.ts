/** Where the graph of a value draws, and how the value is written. */

import { FAR_AWAY_M } from "../../model/changes";
import { formatDistance, type LengthUnit } from "../../model/distance";
import type { KeyOwner } from "../../model/key_lanes";
import type { Place, Side } from "../../model/spline";
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

/** Least distance of a handle from its key, CSS px: both are pressed, and each needs room for that. */
const LEAST_ARM_PX = 26;

/** Where the end of a handle is shown: away from its key, however short the handle is. */
export function handlePlace(
  plot: Plot,
  key: Place,
  end: Place,
  side: Side,
): { readonly x: number; readonly y: number } {
  const [x, y] = [plot.x(key.time), plot.y(key.value)];
  const [right, down] = [plot.x(end.time) - x, plot.y(end.value) - y];
  const length = Math.hypot(right, down);
  if (length >= LEAST_ARM_PX) return { x: x + right, y: y + down };
  if (length < 0.01) return { x: x + (side === "in" ? -LEAST_ARM_PX : LEAST_ARM_PX), y };
  return { x: x + (right / length) * LEAST_ARM_PX, y: y + (down / length) * LEAST_ARM_PX };
}

export const SIDES: readonly Side[] = ["in", "out"];

export function isDistance(owner: KeyOwner): boolean {
  return "setting" in owner && owner.setting === "focusDistanceM";
}

/** A value as it is written: a distance in the unit of the page, and one far away as infinity. */
export function formatValue(owner: KeyOwner, value: number, unit: LengthUnit): string {
  return isDistance(owner) ? formatDistance(value < FAR_AWAY_M ? value : Infinity, unit) : trim(value, 3);
}
