/**
 * Counts of a picture's display values, 0 to 255: its histogram, waveform and vectorscope. Every pixel counts. Luma and chroma are
 * those of Rec. 709 (ITU-R BT.709-6, 3.2 and 3.3), of the values as they are coded for the display.
 */

export const SCOPES = ["histogram", "waveform", "parade", "vectorscope"] as const;
export type Scope = (typeof SCOPES)[number];

export const CHANNELS = ["red", "green", "blue", "luma"] as const;
export type Channel = (typeof CHANNELS)[number];

/** Levels of a channel. */
export const LEVELS = 256;

type Rgb = readonly [number, number, number];

/** Weights of red, green and blue in luma, in units of 0.0001: sums of whole numbers are exact. */
const LUMA: Rgb = [2126, 7152, 722];
const ONE = 10_000;
/** What B − Y and R − Y are divided by for Cb and Cr, in the same unit: twice one minus the weight. */
const [CB, CR] = [2 * (ONE - LUMA[2]), 2 * (ONE - LUMA[0])];

/** The level of each pixel, in each channel; luma is rounded, halves up. */
export type Planes = Readonly<Record<Channel, Uint8Array>>;

/** @param rgba bytes of a picture, pixel by pixel. */
export function planesOf(rgba: Uint8ClampedArray): Planes {
  const pixels = rgba.length / 4;
  const plane = (): Uint8Array => new Uint8Array(pixels);
  const [red, green, blue, luma] = [plane(), plane(), plane(), plane()];
  for (let pixel = 0, at = 0; pixel < pixels; pixel++, at += 4) {
    const r = (red[pixel] = rgba[at] ?? 0);
    const g = (green[pixel] = rgba[at + 1] ?? 0);
    const b = (blue[pixel] = rgba[at + 2] ?? 0);
    luma[pixel] = Math.floor((lumaOf(r, g, b) + ONE / 2) / ONE);
  }
  return { red, green, blue, luma };
}

/** Luma in units of 0.0001. */
function lumaOf(r: number, g: number, b: number): number {
  return LUMA[0] * r + LUMA[1] * g + LUMA[2] * b;
}

/** Pixels at each level. */
export function histogramOf(plane: Uint8Array): Uint32Array {
  const counts = new Uint32Array(LEVELS);
  for (const level of plane) counts[level] = (counts[level] ?? 0) + 1;
  return counts;
}

/** Counts in two dimensions, row by row from the top. */
export interface Density {
  readonly width: number;
  readonly height: number;
  readonly counts: Uint32Array<ArrayBuffer>;
  /** The count that is drawn as bright as can be. */
  readonly full: number;
}

/** Most columns of a waveform. */
export const MOST_COLUMNS = 512;
/** Part of a column's pixels that is drawn as bright as can be, where it is at one level. */
const FULL_OF_COLUMN = 0.1;

/**
 * Pixels at each level, for each column: white is the top row. Wider pictures than `MOST_COLUMNS` have several of their columns
 * in one.
 */
export function waveformOf(plane: Uint8Array, width: number): Density {
  const columns = Math.min(width, MOST_COLUMNS);
  const counts = new Uint32Array(columns * LEVELS);
  const places = Uint32Array.from({ length: width }, (_, x) => Math.floor((x * columns) / width));
  for (let at = 0, x = 0; at < plane.length; at++, x = x + 1 === width ? 0 : x + 1) {
    const bin = (LEVELS - 1 - (plane[at] ?? 0)) * columns + (places[x] ?? 0);
    counts[bin] = (counts[bin] ?? 0) + 1;
  }
  return { width: columns, height: LEVELS, counts, full: (FULL_OF_COLUMN * plane.length) / columns };
}

/** Part of a picture's pixels that is drawn as bright as can be, where they have one colour. */
const FULL_OF_PICTURE = 0.001;

/**
 * Pixels at each chroma: Cb goes from −128 on the left to 127 on the right, and Cr from 127 at the top to −128. Both are rounded, halves
 * up, and 127.5, that of full blue and red, is at 127.
 */
export function vectorscopeOf({ red, green, blue }: Planes): Density {
  const counts = new Uint32Array(LEVELS * LEVELS);
  for (let at = 0; at < red.length; at++) {
    const r = red[at] ?? 0;
    const b = blue[at] ?? 0;
    const luma = lumaOf(r, green[at] ?? 0, b);
    const cb = Math.min(Math.round((ONE * b - luma) / CB), 127);
    const cr = Math.min(Math.round((ONE * r - luma) / CR), 127);
    const bin = (127 - cr) * LEVELS + 128 + cb;
    counts[bin] = (counts[bin] ?? 0) + 1;
  }
  return { width: LEVELS, height: LEVELS, counts, full: FULL_OF_PICTURE * red.length };
}

/** Cb and Cr of a colour of 0 to 255, −127.5 to 127.5. */
export function chromaOf(r: number, g: number, b: number): [number, number] {
  const luma = lumaOf(r, g, b);
  return [(ONE * b - luma) / CB, (ONE * r - luma) / CR];
}

/** Level of the colours of the targets: bars of 75 %. */
const BAR = 0.75 * 255;

/** The six colours that a vectorscope has targets for. */
export const TARGETS: readonly { readonly name: string; readonly chroma: readonly [number, number] }[] = (
  [
    ["R", 1, 0, 0],
    ["Yl", 1, 1, 0],
    ["G", 0, 1, 0],
    ["Cy", 0, 1, 1],
    ["B", 0, 0, 1],
    ["Mg", 1, 0, 1],
  ] as const
).map(([name, r, g, b]) => ({ name, chroma: chromaOf(BAR * r, BAR * g, BAR * b) }));

/** Direction of the line that skin of all colours lies about, degrees from +Cb towards +Cr: that of +I in NTSC. */
export const SKIN_DEG = 123;

/** Figures of a picture in numbers, each 0 to 1. */
export interface Figures {
  /** Mean of luma. */
  readonly mean: number;
  /** Shares of the pixels with a channel at 0 and at 255. */
  readonly low: number;
  readonly high: number;
}

export function figuresOf({ red, green, blue }: Planes): Figures {
  let [sum, low, high] = [0, 0, 0];
  for (let at = 0; at < red.length; at++) {
    const r = red[at] ?? 0;
    const g = green[at] ?? 0;
    const b = blue[at] ?? 0;
    sum += lumaOf(r, g, b);
    if (r === 0 || g === 0 || b === 0) low++;
    if (r === 255 || g === 255 || b === 255) high++;
  }
  const pixels = Math.max(red.length, 1);
  return { mean: sum / (pixels * ONE * 255), low: low / pixels, high: high / pixels };
}

/** RGBA of a density in a colour on black: brighter by the root of the counts, up to the full one. */
export function painted({ counts, full }: Density, [r, g, b]: Rgb): Uint8ClampedArray<ArrayBuffer> {
  const rgba = new Uint8ClampedArray(4 * counts.length);
  for (let bin = 0; bin < counts.length; bin++) {
    const light = Math.sqrt(Math.min((counts[bin] ?? 0) / full, 1));
    rgba[4 * bin] = light * r;
    rgba[4 * bin + 1] = light * g;
    rgba[4 * bin + 2] = light * b;
    rgba[4 * bin + 3] = 255;
  }
  return rgba;
}

/** The largest count between both ends of a histogram, where clipped pixels heap up. */
export function peakOf(histograms: readonly Uint32Array[]): number {
  return Math.max(1, ...histograms.flatMap((counts) => [...counts.subarray(1, LEVELS - 1)]));
}

/** Outline of a histogram as a path: a step for each level, as wide as one and as high as its count. */
export function outlineOf(counts: Uint32Array): string {
  return `M0 0${[...counts].map((count) => `V${count}h1`).join("")}V0Z`;
}
