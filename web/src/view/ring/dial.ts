/** Geometry of the ring as it is drawn: an arc of a large circle whose scale goes past a fixed line at its top. */

export interface Dial {
  readonly width: number;
  readonly height: number;
  /** Of the circle between the marking disk and the scale, px. */
  readonly radius: number;
  /** Place of a turn at a distance from that circle, outwards, with the angle that it stands at, degrees. */
  readonly at: (turn: number, outwards: number) => { readonly x: number; readonly y: number; readonly angle: number };
  /** Whether a turn is on the part that is seen. */
  readonly shows: (turn: number) => boolean;
  /** Turn for a way of the pointer, px. */
  readonly turnOf: (px: number) => number;
  /** An arc so far outwards, as a path. */
  readonly arc: (outwards: number) => string;
}

/** Room above the circle, and by how much the arc falls to both sides, px. */
const [ABOVE, FALL] = [30, 46];
const [HEIGHT, LEAST_WAY] = [104, 900];
/** Length of the whole scale, widths of what is seen. */
const WAYS_SEEN = 2.2;

/** @param now the turn that the ring is at. */
export function dialOf(width: number, now: number): Dial {
  const radius = (width * width) / (8 * FALL) + FALL / 2;
  const way = Math.max(WAYS_SEEN * width, LEAST_WAY);
  const middle = { x: width / 2, y: ABOVE + radius };
  const half = Math.asin(Math.min(width / 2 / radius, 1));
  const at = (turn: number, outwards: number): { x: number; y: number; angle: number } => {
    const angle = ((turn - now) * way) / radius;
    const far = radius + outwards;
    return {
      x: middle.x + far * Math.sin(angle),
      y: middle.y - far * Math.cos(angle),
      angle: (angle * 180) / Math.PI,
    };
  };
  return {
    width,
    height: HEIGHT,
    radius,
    at,
    shows: (turn) => Math.abs(((turn - now) * way) / radius) <= half + 0.05,
    turnOf: (px) => px / way,
    arc: (outwards) => {
      const far = radius + outwards;
      const [x, y] = [far * Math.sin(half + 0.05), far * Math.cos(half + 0.05)];
      const r = far.toFixed(1);
      return `M${(middle.x - x).toFixed(1)} ${(middle.y - y).toFixed(1)}A${r} ${r} 0 0 1 ${(middle.x + x).toFixed(1)} ${(middle.y - y).toFixed(1)}`;
    },
  };
}
