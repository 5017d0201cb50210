/** Quality of a requested picture: that of the final one, where it is live. */

export interface Quality {
  readonly width: number;
  readonly height: number;
  /** Lens rays for each pixel. */
  readonly rays: number;
  /** Depth layers at most: each is drawn from the whole scene anew. */
  readonly layers: number;
  /** Layers are peeled this many times finer than the picture. */
  readonly supersample: number;
  /** Moments of the shutter's opening; 1 stops motion. */
  readonly motion: number;
  /** Whether the scene is drawn once, and things move straight on: quicker than at each moment anew. */
  readonly motionBy: "moments" | "velocities";
  readonly format: "png" | "jpeg";
}

/** Longest side of a picture at rest that is shown as a whole. */
const MOST_PX = 1920;

/** A picture that fills a box of device pixels. */
export function restQuality(widthPx: number, heightPx: number, motion = 1): Quality {
  const scale = Math.min(1, MOST_PX / Math.max(widthPx, heightPx));
  const size = even(widthPx * scale, heightPx * scale);
  return { ...size, rays: 100, layers: 4, supersample: 0, motion, motionBy: "velocities", format: "png" };
}

/** Size of a picture that is delivered with a width. */
export function deliveredSize(widthPx: number, aspect: number): { width: number; height: number } {
  return even(widthPx, widthPx / aspect);
}

/** px */
export interface PictureSize {
  readonly width: number;
  readonly height: number;
}

/** Size of the picture that is wanted. */
export interface PictureBox extends PictureSize {
  /** Whether it is that of the delivered picture, which has all its pixels. */
  readonly isDelivered?: boolean;
}

/** A picture at rest: as large as it is on screen, or as it is delivered. */
export function wantedQuality({ width, height, isDelivered = false }: PictureBox, motion = 1): Quality {
  return { ...restQuality(width, height, motion), ...(isDelivered && { width, height }) };
}

/** Moments of a picture at rest that shows motion. */
export const MOTION_MOMENTS = 16;

/** The quality while something moves, where pictures are not live: little work, and always the same. */
export function draftQuality(rest: Quality): Quality {
  const size = even(rest.width / 2, rest.height / 2);
  return { ...rest, ...size, rays: 24, layers: 2, supersample: 1, motion: 1, format: "jpeg" };
}

/** What makes the frames that are cached: all of the lens, or the blur of one picture, which takes a fraction of the time. */
export type CacheEngine = "lens" | "flag";

/** Width of cached frames: no less than what shows who is sharp. */
const CACHE_WIDTH_PX: Readonly<Record<CacheEngine, number>> = { lens: 960, flag: 480 };
/** Longest wait for a cached frame by the lens, ms. */
const MOST_CACHE_MS = 1000;

/** The engine for cached frames, by the time that an exact picture took. */
export function fittingEngine(exact: { width: number; height: number; tookMs: number } | null): CacheEngine {
  if (exact === null) return "flag";
  const pixels = CACHE_WIDTH_PX.lens ** 2 * (exact.height / exact.width);
  return exact.tookMs * (pixels / (exact.width * exact.height)) <= MOST_CACHE_MS ? "lens" : "flag";
}

/** The quality of a cached frame, which has no motion blur. */
export function cacheQuality(engine: CacheEngine, aspect: number): Quality {
  const width = CACHE_WIDTH_PX[engine];
  return { ...restQuality(width, width / aspect), format: "jpeg" };
}

/** Even sizes, as chroma-subsampled JPEGs and movies like them, and never none. */
function even(width: number, height: number): { width: number; height: number } {
  const round = (side: number): number => Math.max(16, Math.round(side / 2) * 2);
  return { width: round(width), height: round(height) };
}

/** Where a picture of an aspect ratio stands in a box: as large as fits, centred. CSS pixels. */
export function letterbox(
  boxWidth: number,
  boxHeight: number,
  aspect: number,
): { left: number; top: number; width: number; height: number } {
  const width = Math.max(0, Math.min(boxWidth, boxHeight * aspect));
  const height = width / aspect;
  return { left: (boxWidth - width) / 2, top: (boxHeight - height) / 2, width, height };
}
