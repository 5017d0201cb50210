/** What the service takes of keys (`service/models/base.py`). */

import type { Changes } from "./changes";

/** How far from 0 a time may be, time codes. */
export const MOST_TIME = 1e9;
/** How far a handle may reach, time codes, and how far from 0 its slope and the value of a key may be. */
export const [MOST_WIDTH, MOST_VALUE] = [1e6, 1e9];

/** What of keys may be beyond what the service takes. */
export type Beyond = "time" | "value" | "handle";

/** What of the keys that changes set or remove is beyond what the service takes; null for nothing. */
export function beyondLimits(changes: Changes): Beyond | null {
  for (const change of changes) {
    const beyond = beyondIn(change);
    if (beyond) return beyond;
  }
  return null;
}

function beyondIn(change: Changes[number]): Beyond | null {
  if (change.type === "unkeyPoint" || change.type === "unkeySetting" || change.type === "unkeyCamera")
    return isWithin(change.time, MOST_TIME) ? null : "time";
  if (change.type === "moveCameraKeys")
    return change.moves.every(({ newTime }) => isWithin(newTime, MOST_TIME)) ? null : "time";
  if (change.type !== "keyPoint" && change.type !== "keySetting") return null;
  const { time, value, tangents } = change.key;
  if (!isWithin(time, MOST_TIME)) return "time";
  if (!isWithin(value, MOST_VALUE)) return "value";
  const { inSlope = 0, inWidth = 0, outSlope = 0, outWidth = 0 } = tangents ?? {};
  const isHandle =
    [inSlope, outSlope].every((slope) => isWithin(slope, MOST_VALUE)) &&
    [inWidth, outWidth].every((width) => isWithin(width, MOST_WIDTH));
  return isHandle ? null : "handle";
}

function isWithin(value: number, most: number): boolean {
  return Math.abs(value) <= most; // what is no number is not
}
