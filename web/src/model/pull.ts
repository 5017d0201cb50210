/**
 * Pulling focus: what one click changes.
 *
 * Focus goes to the weighted mean of the points' inverse depths, so a rack is a pair of weight keys. A click at a time
 * means "this is sharp now": the point gets weight 1 at that time and all others get 0. At the neighbouring times where
 * another point has a key, this point gets 0, so that the focus there stays as it was and racks in between.
 */

import type { Key } from "./keys";
import { keysOf, type FocusPoint } from "./shot";
import { nearestTime, sameTime } from "./time";

/** One weight key to set. */
export interface WeightKey {
  readonly point: string;
  readonly time: number;
  readonly value: number;
}

/**
 * The weight keys that give a point the focus at a time.
 *
 * @param name the point that is to be sharp; it may be new and not yet among `points`.
 */
export function pullTo(name: string, time: number, points: readonly FocusPoint[]): WeightKey[] {
  const others = points.filter((point) => point.name !== name && counts(point));
  const rivals = others.filter((point) => point.settings.weight > 0);
  const own = points.filter((point) => point.name === name).flatMap((point) => keysOf(point, "weight"));
  const decided = others.flatMap((point) => keysOf(point, "weight").map((key) => key.time));
  const before = nearestTime(
    decided.filter((t) => t < time && !sameTime(t, time)),
    time,
  );
  const after = nearestTime(
    decided.filter((t) => t > time && !sameTime(t, time)),
    time,
  );
  const handOver = [before, after]
    .filter((t): t is number => t !== null && !keyedBetween(own, t, time))
    .map((t) => ({ point: name, time: t, value: 0 }));
  return [
    ...handOver,
    { point: name, time, value: 1 },
    ...rivals.map((point) => ({ point: point.name, time, value: 0 })),
  ];
}

/** A point that is off now and is never switched on does not pull, and is left alone. */
function counts(point: FocusPoint): boolean {
  return point.settings.enabled || keysOf(point, "enabled").length > 0;
}

/** Whether the point itself already has a say at `edge`, or between it and `time`. */
function keyedBetween(own: readonly Key[], edge: number, time: number): boolean {
  const [low, high] = edge < time ? [edge, time] : [time, edge];
  return own.some((key) => !sameTime(key.time, time) && key.time >= low - 1e-4 && key.time <= high + 1e-4);
}

/** A name for a new focus point that none has: the target's own, made an identifier, or with the first number that is free: `lamp_2`. */
export function freshName(target: string, taken: readonly string[]): string {
  const stem = target.replace(/[^A-Za-z0-9_]/g, "_").replace(/^(?=\d)/, "_") || "focus";
  if (!taken.includes(stem)) return stem;
  for (let number = 2; ; number += 1) {
    const name = `${stem}_${number.toString()}`;
    if (!taken.includes(name)) return name;
  }
}
