/** Groups of focus points, by the name that each point has of its group. */

import type { FocusPoint } from "./shot";

export interface PointGroup {
  /** Empty for the points without a group. */
  readonly name: string;
  readonly points: readonly FocusPoint[];
}

/** The names of the groups, in the order of their first points. */
export function groupNames(points: readonly FocusPoint[]): readonly string[] {
  return [...new Set(points.map(({ group }) => group))].filter((name) => name !== "");
}

/** The points by group: those without one first, unless there are none. */
export function groupsOf(points: readonly FocusPoint[]): readonly PointGroup[] {
  return ["", ...groupNames(points)]
    .map((name) => ({ name, points: points.filter(({ group }) => group === name) }))
    .filter((group) => group.points.length > 0);
}
