/** Racks: whether the focus can go over from one point to another, as the service judges it (`usd_schemas.racks`). */

import { MOST_TIME } from "./key_limits";
import { weightOf } from "./pull";
import { keysOf, type FocusPoint } from "./shot";
import { valueAt } from "./spline";
import { formatFrame, sameTime } from "./time";

/** Reason why a rack cannot be; null where it can. */
export function rackProblem(
  from: FocusPoint,
  to: FocusPoint,
  { start, end }: { readonly start: number; readonly end: number },
): string | null {
  if (end > MOST_TIME) return "The rack would end too far away.";
  for (const [point, time] of [
    [from, start],
    [to, end],
  ] as const) {
    if (!isOn(point, time)) return `${point.name} is switched off at ${formatFrame(time)}.`;
  }
  for (const point of [from, to]) {
    const within = keysOf(point, "weight").find(({ time }) => time > start && time < end && !isEnd(time, start, end));
    if (within) return `The weight of ${point.name} has a key at ${formatFrame(within.time)}, within the rack.`;
  }
  const weight = weightOf(from);
  if ((valueAt(weight.keys, start) ?? weight.value) <= 0)
    return `${from.name} is not in focus at ${formatFrame(start)}: its weight there is 0.`;
  const before = weightOf(to).keys.findLast(({ time }) => time < start && !sameTime(time, start));
  return before && before.value > 0
    ? `${to.name} is in focus at ${formatFrame(start)} already: its weight has a key at ${formatFrame(before.time)}.`
    : null;
}

function isOn(point: FocusPoint, time: number): boolean {
  return (valueAt(keysOf(point, "enabled"), time) ?? Number(point.settings.enabled)) > 0;
}

function isEnd(time: number, start: number, end: number): boolean {
  return sameTime(time, start) || sameTime(time, end);
}
