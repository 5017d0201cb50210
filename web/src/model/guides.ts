/** Framing guides: places on the picture, as shares of its width and height from its top left corner. */

import type { Shape } from "./photography";

export interface Box {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
}

/** A guide of a delivery's shape. */
export interface GuideFrame {
  readonly name: string;
  readonly box: Box;
}

/** Marks beside the frames of deliveries. */
export const MARKS = ["action", "title", "thirds", "cross"] as const;
export type GuideMark = (typeof MARKS)[number];

/** Shares of width and height that are safe for action and for titles (SMPTE ST 2046-1:2009). */
export const SAFE = { action: 0.93, title: 0.9 } as const;

/** What safe areas are of: the whole picture, or the smallest of the chosen guides. */
export const SAFE_WITHIN = ["picture", "guide"] as const;
export type SafeWithin = (typeof SAFE_WITHIN)[number];

/** Darkness outside of the smallest guide, %; and what a key goes through. */
export const STANDARD_MASK = 45;
export const MASKS: readonly number[] = [0, STANDARD_MASK, 75, 100];

export const WHOLE: Box = { left: 0, top: 0, width: 1, height: 1 };

/** The largest frame of a shape within a picture, in its middle. */
export function guideIn(pictureAspect: number, shape: number): Box {
  return shareOf(WHOLE, Math.min(1, shape / pictureAspect), Math.min(1, pictureAspect / shape));
}

/** The middle of a box. */
export function shareOf({ left, top, width, height }: Box, across: number, up = across): Box {
  return {
    left: left + (width * (1 - across)) / 2,
    top: top + (height * (1 - up)) / 2,
    width: width * across,
    height: height * up,
  };
}

/** The chosen guides on a picture, in the order of the shapes. */
export function guideFrames(
  pictureAspect: number,
  shapes: readonly Shape[],
  chosen: readonly string[],
): readonly GuideFrame[] {
  return shapes
    .filter(({ name }) => chosen.includes(name))
    .map(({ name, aspect }) => ({ name, box: guideIn(pictureAspect, aspect) }));
}

/** The guide with the smallest area, the first of equal ones; null where there is none. */
export function smallest(frames: readonly GuideFrame[]): GuideFrame | null {
  const area = ({ box }: GuideFrame): number => box.width * box.height;
  return frames.reduce<GuideFrame | null>((least, one) => (least && area(least) <= area(one) ? least : one), null);
}

/** What the next step through single guides chooses: none after the last one, and after several. */
export function nextGuides(chosen: readonly string[], shapes: readonly Shape[]): readonly string[] {
  const at = shapes.findIndex(({ name }) => name === chosen[0]);
  const next = chosen.length > 1 ? undefined : shapes[at + 1];
  return next ? [next.name] : [];
}

/** The darkness of the mask that comes after another one, %. */
export function nextMask(mask: number): number {
  return MASKS.find((one) => one > mask) ?? 0;
}
