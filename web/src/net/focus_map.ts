/** Decoding of focus maps, whose format `getFocusMap` describes. */

import type { FocusMap } from "../model/focus_map";
import type { Json } from "./convert";
import { openMap } from "./encoded_map";

export async function decodeFocusMap(data: ArrayBuffer): Promise<FocusMap> {
  const { head, bytes } = await openMap<Json["FocusMapHead"]>(data);
  const { width, height, filmMmPerPx } = head;
  const half = 4 * width * height;
  const [cocPx, depthM] = [bytes.subarray(0, half), bytes.subarray(half)].map((part) => floats(part, width, height));
  if (bytes.length !== 2 * half || !cocPx || !depthM) throw new Error("The focus map is not of the size that it says.");
  return { width, height, filmMmPerPx, cocPx, depthM };
}

/** Numbers from the bytes of their differences along a row: all first bytes, all second ones, up to the fourth. */
function floats(bytes: Uint8Array, width: number, height: number): Float32Array {
  const count = width * height;
  const bits = new Uint32Array(count);
  for (let row = 0, at = 0; row < height; row++) {
    for (let column = 0, sum = 0; column < width; column++, at++) {
      const low = (bytes[at] ?? 0) | ((bytes[at + count] ?? 0) << 8);
      const high = ((bytes[at + 2 * count] ?? 0) << 16) | ((bytes[at + 3 * count] ?? 0) << 24);
      sum = (sum + (low | high)) | 0;
      bits[at] = sum;
    }
  }
  return new Float32Array(bits.buffer);
}
