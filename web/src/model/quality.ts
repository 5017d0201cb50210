/**
 * How good a picture to ask for: all of it at rest, and while something moves as much as comes back in time.
 */

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

/** Longest side of a picture at rest; more than this no viewer on the page shows. */
const MOST_PX = 1920;

interface Rung {
  /** Of the width at rest. */
  readonly scale: number;
  readonly rays: number;
  /** Fewer than 2 would show holes behind what is near. */
  readonly layers: number;
}

const CHEAPEST: Rung = { scale: 0.25, rays: 16, layers: 2 };

/** From dear to cheap. */
const LADDER: readonly Rung[] = [
  { scale: 1, rays: 48, layers: 4 },
  { scale: 0.7, rays: 36, layers: 3 },
  { scale: 0.5, rays: 28, layers: 2 },
  { scale: 0.35, rays: 20, layers: 2 },
  CHEAPEST,
];

/** A picture that fills a box of device pixels. */
export function restQuality(widthPx: number, heightPx: number, motion = 1): Quality {
  const scale = Math.min(1, MOST_PX / Math.max(widthPx, heightPx));
  const size = even(widthPx * scale, heightPx * scale);
  return { ...size, rays: 100, layers: 4, supersample: 2, motion, motionBy: "velocities", format: "png" };
}

/** Moments of a picture at rest that shows motion. */
export const MOTION_MOMENTS = 16;

/** The picture for a rung of the ladder. */
export function movingQuality(rest: Quality, rung: number): Quality {
  const { scale, rays, layers } = LADDER[Math.min(Math.max(rung, 0), LADDER.length - 1)] ?? CHEAPEST;
  return {
    ...even(rest.width * scale, rest.height * scale),
    rays,
    layers,
    supersample: 1,
    motion: 1,
    motionBy: "velocities",
    format: "jpeg",
  };
}

/** Rung to start from before anything is known of the service's speed. */
export const FIRST_RUNG = 2;

/**
 * The rung after a moving picture took so long: one down when it was slow, one up when it was quick.
 *
 * The two limits are a factor of 3 apart, more than a rung changes the work, so that it does not swing to and fro.
 */
export function nextRung(rung: number, tookMs: number): number {
  if (tookMs > 240) return Math.min(rung + 1, LADDER.length - 1);
  return tookMs < 80 ? Math.max(rung - 1, 0) : rung;
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
