/** Sharpness of each pixel of a picture: its signed circle of confusion and its depth. */

/** A place in the picture: 0 to 1 from its top left corner. */
type Place = readonly [number, number];

export interface FocusMap {
  /** Pixels; there may be fewer than the picture has. */
  readonly width: number;
  readonly height: number;
  /** Width of a pixel on the film. */
  readonly filmMmPerPx: number;
  /** Radius of the circle of confusion in pixels of the map, negative in front of the focus; row by row from the top. */
  readonly cocPx: Float32Array;
  /** Along the view axis; infinite where nothing is. */
  readonly depthM: Float32Array;
}

/** What a map says of one place. */
export interface MapReading {
  readonly depthM: number;
  /** Diameter of the circle of confusion on the film, negative in front of the focus. */
  readonly cocMm: number;
}

/** Reads the pixel at a place. */
export function readMap(map: FocusMap, [x, y]: Place): MapReading {
  const column = Math.min(Math.max(Math.floor(x * map.width), 0), map.width - 1);
  const row = Math.min(Math.max(Math.floor(y * map.height), 0), map.height - 1);
  const at = row * map.width + column;
  return { depthM: map.depthM[at] ?? NaN, cocMm: 2 * (map.cocPx[at] ?? NaN) * map.filmMmPerPx };
}

/** Width of the picture on the film. */
export function gateWidthMm(map: FocusMap): number {
  return map.width * map.filmMmPerPx;
}
