/** Exposure of each pixel of a picture, and its colours: stops from a grey of 18 %, on the film and before film and grade. */

export interface ExposureMap {
  readonly width: number;
  readonly height: number;
  /** Row by row from the top; minus infinity where there is no light. */
  readonly stops: Float32Array;
}

/** What is drawn over the picture. */
export const EXPOSURE_LOOKS = ["none", "falseColour", "zebra"] as const;
export type ExposureLook = (typeof EXPOSURE_LOOKS)[number];

/** Stops above grey from which there are stripes. */
export const ZEBRA_STOPS = ["1", "2", "2.5", "3", "4", "6"] as const;
export type ZebraStops = (typeof ZEBRA_STOPS)[number];

/** Colours of false colour, each for a stop: from half a stop below its number to half a stop above. The ends take what is beyond. */
export const BANDS: readonly { readonly stop: number; readonly rgb: readonly [number, number, number] }[] = [
  { stop: -6, rgb: [70, 20, 110] },
  { stop: -5, rgb: [40, 40, 170] },
  { stop: -4, rgb: [30, 90, 200] },
  { stop: -3, rgb: [30, 140, 190] },
  { stop: -2, rgb: [90, 90, 90] },
  { stop: -1, rgb: [125, 125, 125] },
  { stop: 0, rgb: [64, 200, 80] },
  { stop: 1, rgb: [240, 150, 170] },
  { stop: 2, rgb: [205, 205, 205] },
  { stop: 3, rgb: [250, 235, 90] },
  { stop: 4, rgb: [250, 190, 40] },
  { stop: 5, rgb: [240, 120, 30] },
  { stop: 6, rgb: [220, 30, 30] },
];

/** Width of a stripe and of the gap beside it, px. */
const STRIPE_PX = 4;

/** The colour of so many stops from grey. */
export function bandOf(stops: number): readonly [number, number, number] {
  const [least, most] = [BANDS[0]?.stop ?? 0, BANDS.at(-1)?.stop ?? 0];
  const band = BANDS[Math.min(Math.max(Math.round(stops), least), most) - least];
  return band?.rgb ?? [0, 0, 0];
}

/** RGBA of false colour, a pixel for each of the map. */
export function falseColour({ stops }: ExposureMap): Uint8ClampedArray<ArrayBuffer> {
  const pixels = new Uint8ClampedArray(4 * stops.length);
  for (let at = 0; at < stops.length; at++) {
    pixels.set(bandOf(stops[at] ?? 0), 4 * at);
    pixels[4 * at + 3] = 255;
  }
  return pixels;
}

/** RGBA of stripes, at a size: where the light is at least so many stops above grey. */
export function zebra(map: ExposureMap, from: number, width: number, height: number): Uint8ClampedArray<ArrayBuffer> {
  const pixels = new Uint8ClampedArray(4 * width * height);
  for (let row = 0; row < height; row++) {
    const line = Math.floor(((row + 0.5) * map.height) / height) * map.width;
    for (let column = 0; column < width; column++) {
      if (Math.floor((row + column) / STRIPE_PX) % 2 > 0) continue;
      const stops = map.stops[line + Math.floor(((column + 0.5) * map.width) / width)] ?? 0;
      if (stops >= from) pixels.set([255, 255, 255, 230], 4 * (row * width + column));
    }
  }
  return pixels;
}
