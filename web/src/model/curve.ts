/** The focus curve as the page draws it. */

import type { LensSample } from "./shot";
import { sameTime } from "./time";

export interface CurvePoint {
  readonly name: string;
  /** Along the view axis, or null where the point has no place or is behind the camera. */
  readonly depthM: number | null;
  /** Share of the weight that decided the focus, 0 to 1. */
  readonly share: number;
}

export interface CurveSample extends LensSample {
  readonly time: number;
  readonly points: readonly CurvePoint[];
}

export type Curve = readonly CurveSample[];

/** The sample at a time, if the curve has it. */
export function sampleAt(curve: Curve, time: number): CurveSample | null {
  let low = 0;
  let high = curve.length - 1;
  while (low <= high) {
    const middle = (low + high) >> 1;
    const sample = curve[middle];
    if (!sample) return null;
    if (sameTime(sample.time, time)) return sample;
    if (sample.time < time) low = middle + 1;
    else high = middle - 1;
  }
  return null;
}

/** The distances that a drawing of the curve must hold: the focus and, where they are finite, the points' depths. */
export function distancesOf(curve: Curve): number[] {
  return curve.flatMap((sample) => [
    sample.focusDistanceM,
    ...sample.points.flatMap((point) => (point.depthM !== null && point.depthM > 0 ? [point.depthM] : [])),
  ]);
}

/** Names of the points of a curve, in the order in which they come. */
export function pointNames(curve: Curve): string[] {
  return [...new Set(curve.flatMap((sample) => sample.points.map((point) => point.name)))];
}
