/**
 * The set from above: the plane of the camera's right vector and its optical axis.
 *
 * A place in the plan is a distance to the right of the optical axis and a depth along it, in metres, so that depths in it are those
 * of all readouts, whichever way the camera is pitched or rolled. Heights are dropped. Sharpness is inverse depths from the pupil
 * by slopes: what is linear in these is a straight line of the plan.
 */

import { METRES_PER_FOOT, type LengthUnit } from "./distance";
import type { Readout } from "./shot";
import { dot, type Vector } from "./vector";

/** In the plan: metres to the right of the optical axis, and along it. */
export type Place = readonly [right: number, depth: number];

/** Sharpness in one direction; inverse depths from the pupil, 1/m. 0 is infinity, and below 0 there is none ahead. */
export interface CutPlace {
  /** Metres to the right for each metre of depth. */
  readonly slope: number;
  /** Infinite for a pinhole. */
  readonly nearW: number;
  readonly focusW: number;
  readonly farW: number;
}

export type CutLine = "nearW" | "focusW" | "farW";

/** A camera from above, at one time. */
export interface TopView {
  /** Of the camera's origin, from where depths count. */
  readonly positionM: Vector;
  readonly right: Vector;
  readonly ahead: Vector;
  /** How far the pupil lies behind the origin; 0 but for an orthographic camera. */
  readonly setBackM: number;
  readonly gateMm: number;
  /** Slopes of the left and the right edge of the picture. */
  readonly edges: readonly [number, number];
  /** On the view axis. */
  readonly axis: CutPlace;
  /** From the left edge of the picture to the right one, on the level of the axis. */
  readonly cut: readonly CutPlace[];
}

export interface PointPath {
  readonly name: string;
  /** At each of the times; null where the point has no place. */
  readonly positionsM: readonly (Vector | null)[];
}

/** The ways of a camera and its focus points over a shot. */
export interface Paths {
  /** USD time codes, rising. */
  readonly times: readonly number[];
  readonly cameraM: readonly Vector[];
  readonly points: readonly PointPath[];
}

function minus(a: Vector, b: Vector): Vector {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

/** Where a place of the world is in the plan. */
export function toPlan({ positionM, right, ahead }: TopView, at: Vector): Place {
  const way = minus(at, positionM);
  return [dot(way, right), dot(way, ahead)];
}

/** The place of the world that is as high above the plan as another one, and at a place of the plan. */
export function movedTo(view: TopView, from: Vector, to: Place): Vector {
  const [right, depth] = toPlan(view, from);
  const [byRight, byDepth] = [to[0] - right, to[1] - depth];
  const along = (axis: 0 | 1 | 2): number => from[axis] + byRight * view.right[axis] + byDepth * view.ahead[axis];
  return [along(0), along(1), along(2)];
}

/**
 * The cut through what a lens as read off holds sharp, where it has changed since the view was read: moved as far in inverse depth as
 * on the view axis, with a depth of field as much deeper.
 */
export function withReadout(
  view: TopView,
  { focusDistanceM, nearM }: Pick<Readout, "focusDistanceM" | "nearM">,
): TopView {
  const { axis, setBackM } = view;
  const [focusW, nearW] = [1 / (focusDistanceM + setBackM), 1 / (nearM + setBackM)];
  if (isSame(focusW, Math.max(axis.focusW, 0)) && isSame(nearW, axis.nearW)) return view;
  const by = focusW - axis.focusW;
  const [reach, before] = [nearW - focusW, axis.nearW - axis.focusW];
  const changed = (place: CutPlace): CutPlace => {
    const own = place.nearW - place.focusW;
    const deep = Number.isFinite(reach) && Number.isFinite(before) && before > 0 ? (own * reach) / before : reach;
    const moved = place.focusW + by;
    return { slope: place.slope, nearW: moved + deep, focusW: moved, farW: moved - deep };
  };
  return { ...view, axis: changed(axis), cut: view.cut.map(changed) };
}

function isSame(a: number, b: number): boolean {
  return a === b || Math.abs(a - b) <= 1e-9 * Math.max(Math.abs(a), Math.abs(b));
}

/** Where a ray of a slope is at an inverse depth from the pupil. */
function onRay({ setBackM }: TopView, slope: number, w: number): Place {
  return [slope / w, 1 / w - setBackM];
}

/** Places of a cut, with those between them at which one of its lines crosses an inverse depth. */
function crossed(cut: readonly CutPlace[], lines: readonly CutLine[], w: number): CutPlace[] {
  return cut.flatMap((place, at) => {
    const next = cut[at + 1];
    if (!next) return [place];
    const shares = lines
      .map((line) => (w - place[line]) / (next[line] - place[line]))
      .filter((share) => share > 0 && share < 1);
    return [place, ...shares.toSorted((a, b) => a - b).map((share) => between(place, next, share))];
  });
}

function between(a: CutPlace, b: CutPlace, share: number): CutPlace {
  const mixed = (name: keyof CutPlace): number =>
    a[name] === b[name] ? a[name] : a[name] + share * (b[name] - a[name]);
  return { slope: mixed("slope"), nearW: mixed("nearW"), focusW: mixed("focusW"), farW: mixed("farW") };
}

/**
 * A line of the cut in pieces: what of it is nearer than a limit.
 *
 * @param leastW inverse depth of the limit from the pupil, above 0.
 */
export function lineOf(view: TopView, line: CutLine, leastW: number): Place[][] {
  const pieces: Place[][] = [];
  let isOpen = false;
  for (const place of crossed(view.cut, [line], leastW)) {
    const w = place[line];
    // A place at which it crosses the limit may miss it by a rounding.
    const isNear = w >= leastW * (1 - 1e-9) && Number.isFinite(w);
    if (isNear && !isOpen) pieces.push([]);
    if (isNear) pieces.at(-1)?.push(onRay(view, place.slope, w));
    isOpen = isNear;
  }
  return pieces.filter((piece) => piece.length > 1);
}

/** The outline of what is sharp, out to a limit: along the near limit and back along the far one. */
export function wedgeOf(view: TopView, leastW: number): Place[] {
  const places = crossed(view.cut, ["nearW", "farW"], leastW);
  const side = (line: CutLine): Place[] =>
    places.map((place) => {
      const w = Math.max(place[line], leastW);
      return Number.isFinite(w) ? onRay(view, place.slope, w) : [0, -view.setBackM];
    });
  return [...side("nearW"), ...side("farW").reverse()];
}

/** The lines of the two edges of the picture, from the pupil to a limit. */
export function edgesOf(view: TopView, leastW: number): readonly (readonly [Place, Place])[] {
  return view.edges.map((slope) => [[0, -view.setBackM], onRay(view, slope, leastW)]);
}

/**
 * From a point to the focus on its own ray, which is as far along the axis as the point is off the focus.
 *
 * @param focusDistanceM depth of the focus where the point stands in the picture; may be infinite.
 */
export function residualOf(view: TopView, at: Place, focusDistanceM: number, leastW: number): readonly [Place, Place] {
  const slope = at[0] / (at[1] + view.setBackM);
  return [at, onRay(view, slope, Math.max(1 / (focusDistanceM + view.setBackM), leastW))];
}

/** The direction in which the camera looks, clockwise from the world's north (-Z), rad; that of its picture's top where it looks up or down. */
export function headingOf({ right, ahead }: TopView): number {
  const [x, , z] = Math.hypot(ahead[0], ahead[2]) > 1e-3 ? ahead : upOf(right, ahead);
  return Math.atan2(x, -z);
}

/** Up in the picture: right × ahead. */
function upOf(a: Vector, b: Vector): Vector {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** A way cut off where it is unknown, at the time codes of its places. */
export function placeOnPath({ times }: Paths, positionsM: readonly (Vector | null)[], time: number): Vector | null {
  const after = times.findIndex((other) => other >= time - 1e-6);
  const [a, b] = [positionsM[after - 1], positionsM[after]];
  const [start, end] = [times[after - 1], times[after]];
  if (!b || end === undefined) return null;
  if (Math.abs(end - time) <= 1e-6) return b;
  if (!a || start === undefined) return null;
  const share = (time - start) / (end - start);
  const mixed = (axis: 0 | 1 | 2): number => a[axis] + share * (b[axis] - a[axis]);
  return [mixed(0), mixed(1), mixed(2)];
}

/** What of a plan is shown, and how: its middle, its scale and its turn. */
export interface Sheet {
  /** CSS px. */
  readonly width: number;
  readonly height: number;
  readonly pxPerM: number;
  /** Place of the plan in the middle of the drawing. */
  readonly middle: Place;
  /** By which the plan is turned clockwise, rad. */
  readonly turn: number;
}

/** A place of the drawing: px to the right and down from its top left corner. */
export type Spot = readonly [x: number, y: number];

function turned([x, y]: readonly [number, number], turn: number): readonly [number, number] {
  const [cos, sin] = [Math.cos(turn), Math.sin(turn)];
  return [x * cos + y * sin, y * cos - x * sin];
}

export function toSheet(sheet: Sheet, at: Place): Spot {
  const [x, y] = turned([at[0] - sheet.middle[0], at[1] - sheet.middle[1]], sheet.turn);
  return [sheet.width / 2 + x * sheet.pxPerM, sheet.height / 2 - y * sheet.pxPerM];
}

export function fromSheet(sheet: Sheet, [x, y]: Spot): Place {
  const way = [(x - sheet.width / 2) / sheet.pxPerM, (sheet.height / 2 - y) / sheet.pxPerM] as const;
  const [right, depth] = turned(way, -sheet.turn);
  return [right + sheet.middle[0], depth + sheet.middle[1]];
}

/** Scales between which a drawing is zoomed, px for each metre. */
const [LEAST_SCALE, MOST_SCALE] = [0.02, 20_000];

/** A drawing so many times as large, with one spot where it is. */
export function zoomed(sheet: Sheet, factor: number, spot: Spot): Sheet {
  const pxPerM = Math.min(Math.max(sheet.pxPerM * factor, LEAST_SCALE), MOST_SCALE);
  const held = fromSheet(sheet, spot);
  const now = fromSheet({ ...sheet, pxPerM }, spot);
  return { ...sheet, pxPerM, middle: [sheet.middle[0] + held[0] - now[0], sheet.middle[1] + held[1] - now[1]] };
}

/** A drawing shifted by so many px. */
export function panned(sheet: Sheet, right: number, down: number): Sheet {
  return { ...sheet, middle: fromSheet(sheet, [sheet.width / 2 - right, sheet.height / 2 - down]) };
}

/** The least and the greatest coordinate of places along an axis; there may be more of them than a call takes arguments. */
export function endsOf(places: readonly Place[], axis: 0 | 1): readonly [least: number, greatest: number] {
  let [least, greatest] = [Infinity, -Infinity];
  for (const place of places) {
    least = Math.min(least, place[axis]);
    greatest = Math.max(greatest, place[axis]);
  }
  return [least, greatest];
}

/** A drawing in which places are all to be seen, with room around them. */
export function fitted(sheet: Sheet, places: readonly Place[], marginPx: number): Sheet {
  const spots = places.map((place) => turned(place, sheet.turn));
  const [left, right] = endsOf(spots, 0);
  const [low, high] = endsOf(spots, 1);
  const room = (size: number): number => Math.max(size - 2 * marginPx, size / 4);
  const scale = Math.min(room(sheet.width) / (right - left), room(sheet.height) / (high - low), 400);
  const pxPerM = Math.min(Math.max(scale, LEAST_SCALE), MOST_SCALE);
  return { ...sheet, pxPerM, middle: turned([(left + right) / 2, (low + high) / 2], -sheet.turn) };
}

/** Inverse depth from the pupil beyond which nothing of a drawing lies. */
export function leastWOf(sheet: Sheet, { setBackM }: Pick<TopView, "setBackM">): number {
  const farthest = Math.max(...cornersOf(sheet).map(([, depth]) => depth), 1);
  return 1 / (1.05 * farthest + setBackM);
}

function cornersOf(sheet: Sheet): Place[] {
  const { width, height } = sheet;
  return ([[0, 0], [width, 0], [width, height], [0, height]] as const).map((spot) => fromSheet(sheet, spot)); // prettier-ignore
}

/** A grid over a drawing, in the camera's frame: a line through the camera each way, and others at equal steps. */
export interface Grid {
  readonly stepM: number;
  /** Of the step, in the unit. */
  readonly step: number;
  /** Distances of lines along the axis and across it, m. */
  readonly rights: readonly number[];
  readonly depths: readonly number[];
}

/** The grid with the smallest round step whose lines are so far apart. */
export function gridOf(sheet: Sheet, unit: LengthUnit, leastPx: number): Grid {
  const unitM = unit === "m" ? 1 : METRES_PER_FOOT;
  const least = leastPx / sheet.pxPerM / unitM;
  const power = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 5, 10].map((round) => round * power).find((round) => round >= least * (1 - 1e-9)) ?? 10 * power;
  const corners = cornersOf(sheet);
  const lines = (axis: 0 | 1): number[] => {
    const [first, last] = endsOf(corners, axis);
    const from = Math.ceil(first / (step * unitM));
    return Array.from({ length: Math.floor(last / (step * unitM)) - from + 1 }, (_, k) => (from + k) * step * unitM);
  };
  return { stepM: step * unitM, step, rights: lines(0), depths: lines(1) };
}
