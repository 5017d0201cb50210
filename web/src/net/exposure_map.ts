/** Decoding of exposure maps, whose format `getExposureMap` describes. */

import type { ExposureMap } from "../model/exposure_map";
import type { Json } from "./convert";
import { openMap } from "./encoded_map";

/** The number of a pixel without light. */
const DARK = -32768;

export async function decodeExposureMap(data: ArrayBuffer): Promise<ExposureMap> {
  const { head, bytes } = await openMap<Json["ExposureMapHead"]>(data);
  const { width, height, stepsPerStop } = head;
  const count = width * height;
  if (bytes.length !== 2 * count) throw new Error("The exposure map is not of the size that it says.");
  const stops = new Float32Array(count);
  for (let row = 0, at = 0; row < height; row++) {
    for (let column = 0, sum = 0; column < width; column++, at++) {
      sum = (sum + ((bytes[at] ?? 0) | ((bytes[at + count] ?? 0) << 8))) & 0xffff;
      const number = (sum << 16) >> 16;
      stops[at] = number === DARK ? -Infinity : number / stepsPerStop;
    }
  }
  return { width, height, stops };
}
