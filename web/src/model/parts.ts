/** Parts: prims whose bounds a focus point can follow in place of its surface. */

import { primName, type FocusPoint } from "./shot";

/** The prim that a point is on: a mesh, or the point instancer that multiplies one. */
export function surfaceOf(point: FocusPoint): string {
  return point.anchor.target[0] ?? "";
}

/**
 * The paths that a point can follow: its target and what that is in, nearest first, then a part that is none of them.
 *
 * The root of the scene, which a camera is in too, is left out unless the target is right below it.
 *
 * @param cameras prim paths of the shot's cameras.
 */
export function partsOf(point: FocusPoint, cameras: readonly string[]): readonly string[] {
  const names = surfaceOf(point).split("/").slice(1);
  const paths = names.map((_, depth) => `/${names.slice(0, depth + 1).join("/")}`);
  const isScene = cameras.some((path) => path.startsWith(`${paths[0] ?? ""}/`));
  const parts = (isScene && paths.length > 2 ? paths.slice(1) : paths).reverse();
  return point.part === "" || parts.includes(point.part) ? parts : [...parts, point.part];
}

/** What a point is on, in a word: the part that it follows, or its target. */
export function holderOf(point: FocusPoint): string {
  return primName(point.part || surfaceOf(point));
}
