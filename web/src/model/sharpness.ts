/** What counts as sharp, by how much things miss it, and how that is said. Diameters are on the film. */

import { formatDistance, type LengthUnit } from "./distance";
import type { FocusPoint, PointSharpness } from "./shot";

/** What is drawn over the picture. */
export const LOOKS = ["none", "peaking", "falseColour"] as const;
export type Look = (typeof LOOKS)[number];

/** Where the limit comes from: that of the depth of field, or a circle of so many pixels in the delivered picture. */
export const LIMITS = ["film", "1", "2", "4"] as const;
export type Limit = (typeof LIMITS)[number];

/** Widths of delivered pictures, px. */
export const DELIVERIES = ["1280", "1920", "2048", "3840", "4096"] as const;
export type Delivery = (typeof DELIVERIES)[number];

/** Largest circle of confusion that is sharp. */
export function sharpLimitMm(limit: Limit, filmLimitMm: number, gateMm: number, deliveryPx: number): number {
  return limit === "film" ? filmLimitMm : (Number(limit) * gateMm) / deliveryPx;
}

/** Stops by which the lens must be closed for a circle to be sharp; negative where it may be opened. A circle is as wide as the pupil. */
export function stopsToHold(cocMm: number, limitMm: number): number {
  return 2 * Math.log2(Math.abs(cocMm) / limitMm);
}

/** The f-number at which circles are sharp that are so large now, in thirds of a stop and no wider; 0 (a pinhole) holds all. */
export function holdingStop(fStop: number, cocMm: number, limitMm: number): number {
  const thirds = Math.ceil(3 * (2 * Math.log2(fStop) + stopsToHold(cocMm, limitMm)) - 1e-6);
  return 2 ** (thirds / 6);
}

/** A distance from the focus: +12 cm lies behind it. */
export function formatOffset(offsetM: number, unit: LengthUnit): string {
  if (!Number.isFinite(offsetM)) return offsetM > 0 ? "+∞" : "−∞";
  const sign = offsetM < 0 ? "−" : "+";
  const size = Math.abs(offsetM);
  if (unit === "ft") return `${sign}${formatDistance(size, "ft")}`;
  if (size < 0.9995) return `${sign}${(100 * size).toFixed(size < 0.0995 ? 1 : 0)} cm`;
  return `${sign}${formatDistance(size, "m")}`;
}

/** A diameter on the film in mm, and in pixels of the delivered picture. */
export function formatCircle(cocMm: number, gateMm: number, deliveryPx: number): string {
  const [mm, px] = [Math.abs(cocMm), (Math.abs(cocMm) / gateMm) * deliveryPx];
  return `${mm.toFixed(mm < 0.1 ? 3 : 2)} mm, ${px.toFixed(px < 10 ? 1 : 0)} px`;
}

/** Sharpness of a point. */
export interface Verdict {
  readonly isSharp: boolean;
  /** Of the point behind the focal surface, m. */
  readonly offsetM: number;
  readonly cocMm: number;
}

/** Judges a point; null where the camera does not see its place. */
export function judge({ depthM, cocMm, focusDistanceM }: PointSharpness, limitMm: number): Verdict | null {
  if (depthM === null || cocMm === null || focusDistanceM === null) return null;
  return { isSharp: cocMm <= limitMm, offsetM: depthM - focusDistanceM, cocMm };
}

/** The one with the largest circle of confusion of the points that are to be sharp; null where none has any. */
export function softest<Point extends Pick<FocusPoint, "settings">>(
  points: readonly Point[],
  sharpnessOf: (point: Point) => PointSharpness,
): Point | null {
  const wanted = points.filter(({ settings }) => settings.enabled && settings.kind === "sharp");
  const circle = (point: Point): number => sharpnessOf(point).cocMm ?? -1;
  const largest = Math.max(...wanted.map(circle));
  return wanted.find((point) => circle(point) === largest && largest >= 0) ?? null;
}

/** Points that count for the focus and are to be sharp, and are not. */
export interface Missed {
  readonly point: FocusPoint;
  readonly verdict: Verdict;
}

export function missed(points: readonly FocusPoint[], limitMm: number): Missed[] {
  return points.flatMap((point) => {
    const verdict = judge(point.sharpness, limitMm);
    const counts = point.share > 0 && point.settings.enabled && point.settings.kind === "sharp";
    return counts && verdict && !verdict.isSharp ? [{ point, verdict }] : [];
  });
}
