/** Moves of a camera in the world: orbit, pan, dolly, and the framing of a point. */

import type { Change } from "./changes";
import type { TopView } from "./top_view";
import { dot, type Vector } from "./vector";

/** Where a camera is and where it looks, in the world: metres, +Y up. */
export interface CameraPose {
  readonly positionM: Vector;
  /** Unit vectors: of the optical axis, and up in the picture. */
  readonly ahead: Vector;
  readonly up: Vector;
}

/** A camera as it is taken hold of. */
export interface HeldCamera {
  readonly pose: CameraPose;
  /** What it turns about, and what comes along with the pointer. */
  readonly pivotM: Vector;
  /** Width of the picture for each metre of depth. */
  readonly widthPerM: number;
  /** Width over height of the picture. */
  readonly aspect: number;
}

export const MOVES = ["orbit", "pan", "dolly"] as const;
export type MoveKind = (typeof MOVES)[number];

/** Way of a pointer: to the right in widths of the picture, and down in its heights. */
export type Drag = readonly [right: number, down: number];

/** Turn by a drag over the whole picture, rad. */
const FULL_TURN = Math.PI;
/** Drag, in pictures, by which a dolly halves the distance. */
const HALVES = 0.5;
/** Steepest that a camera looks up or down by an orbit, rad. */
const STEEPEST = (89.5 / 180) * Math.PI;
/** Nearest that a dolly comes to what it goes to, m; and distance of the pivot where none is known. */
const [NEAREST_M, USUAL_M] = [0.01, 5];
/** Farthest pivot, m: a focus beyond is as good as infinite. */
const FARTHEST_M = 1000;

const WORLD_UP: Vector = [0, 1, 0];

function cross(a: Vector, b: Vector): Vector {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** A place that is so far along a direction from another one. */
function along(from: Vector, way: Vector, by: number): Vector {
  return [from[0] + by * way[0], from[1] + by * way[1], from[2] + by * way[2]];
}

function unit(a: Vector): Vector {
  return along([0, 0, 0], a, 1 / Math.hypot(...a));
}

/** A vector turned about a unit vector, by the right hand (Rodrigues). */
function turned(a: Vector, axis: Vector, angle: number): Vector {
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return along(along(along([0, 0, 0], a, cos), cross(axis, a), sin), axis, dot(axis, a) * (1 - cos));
}

export function poseOf({ positionM, right, ahead }: Pick<TopView, "positionM" | "right" | "ahead">): CameraPose {
  return { positionM, ahead, up: cross(right, ahead) };
}

/** Angle by which a camera is turned about its axis against the world's horizon, rad. */
export function rollOf({ ahead, up }: CameraPose): number {
  const right = cross(ahead, up);
  return Math.atan2(-right[1], up[1]);
}

/**
 * What a camera turns about.
 *
 * @param pointM the selected focus point, if it has a place before the camera.
 * @param focusDistanceM along the axis; may be infinite.
 */
export function pivotOf({ positionM, ahead }: CameraPose, pointM: Vector | null, focusDistanceM: number): Vector {
  if (pointM && dot(along(pointM, positionM, -1), ahead) > NEAREST_M) return pointM;
  const isKnown = focusDistanceM > NEAREST_M && focusDistanceM <= FARTHEST_M;
  return along(positionM, ahead, isKnown ? focusDistanceM : USUAL_M);
}

function depthOf({ pose, pivotM }: HeldCamera): number {
  return Math.max(dot(along(pivotM, pose.positionM, -1), pose.ahead), NEAREST_M);
}

/** Turns about the pivot, at the same distance: about the world's vertical, and up or down short of the vertical. */
function orbited({ pose, pivotM }: HeldCamera, [right, down]: Drag): CameraPose {
  const sideways = cross(pose.ahead, WORLD_UP);
  const level = Math.hypot(...sideways) > 1e-6 ? unit(sideways) : cross(pose.ahead, pose.up);
  const pitch = Math.asin(Math.min(Math.max(pose.ahead[1], -1), 1));
  const limit = Math.max(STEEPEST, Math.abs(pitch));
  const tilt = Math.min(Math.max(pitch - down * FULL_TURN, -limit), limit) - pitch;
  const turn = (a: Vector): Vector => turned(turned(a, level, tilt), WORLD_UP, -right * FULL_TURN);
  const from = turn(along(pose.positionM, pivotM, -1));
  return { positionM: along(pivotM, from, 1), ahead: unit(turn(pose.ahead)), up: unit(turn(pose.up)) };
}

/** Moves in the plane of the picture, so that what is as deep as the pivot stays at the pointer. */
function panned(held: HeldCamera, [right, down]: Drag): CameraPose {
  const { pose, widthPerM, aspect } = held;
  const widthM = widthPerM * depthOf(held);
  const aside = along(pose.positionM, cross(pose.ahead, pose.up), -right * widthM);
  return { ...pose, positionM: along(aside, pose.up, (down * widthM) / aspect) };
}

/** Moves along the axis, up to the pivot at most: to the right or up is in. */
function dollied(held: HeldCamera, [right, down]: Drag): CameraPose {
  const depth = depthOf(held);
  const left = Math.max(depth * 2 ** (-(right - down) / HALVES), NEAREST_M);
  return { ...held.pose, positionM: along(held.pose.positionM, held.pose.ahead, depth - left) };
}

const BY_KIND = { orbit: orbited, pan: panned, dolly: dollied } as const;

export function moved(held: HeldCamera, kind: MoveKind, by: Drag): HeldCamera {
  return { ...held, pose: BY_KIND[kind](held, by) };
}

/** The change that puts a camera there: as a key at the time, or with all of its way. */
export function moveCamera({ positionM, ahead, up }: CameraPose, time: number, keyed: boolean): Change {
  return { type: "moveCamera", positionM, ahead, up, time, keyed };
}
