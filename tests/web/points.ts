/** Focus points for tests. */

import type { Key } from "@/model/keys";
import type { FocusPoint, KeyedAttribute } from "@/model/shot";

type Keys = Partial<Record<KeyedAttribute, Record<number, number>>>;

/** A point with weight 1 unless said otherwise; `keys` are values by time. */
export function point(name: string, keys: Keys = {}, settings: Partial<FocusPoint["settings"]> = {}): FocusPoint {
  const rows = Object.entries(keys).map(([attribute, values]) => [attribute, Object.entries(values).map(toKey)]);
  return {
    name,
    anchor: { target: [`/World/${name}`], face: 0, fanTriangle: 0, barycentric: [1, 0, 0], instance: -1 },
    part: "",
    color: "none",
    group: "",
    settings: {
      enabled: true,
      weight: 1,
      kind: "sharp",
      blurMm: 0,
      falloff: 0,
      offset: [0, 0, 0],
      surfaceOffset: 0,
      extent: 1,
      ...settings,
    },
    keys: Object.fromEntries(rows) as FocusPoint["keys"],
    share: 0,
    depthM: 2,
    positionM: [0, 0, -2],
    sharpness: { depthM: 2, cocMm: 0, focusDistanceM: 2 },
    screen: [0.5, 0.5],
  };
}

function toKey([time, value]: [string, number]): Key {
  return { time: Number(time), value, interpolation: "linear" };
}

/** The value of linear keys at a time, as USD has it; `unkeyed` where there are none. */
export function valueAt(keys: readonly Key[], time: number, unkeyed: number): number {
  const sorted = keys.toSorted((a, b) => a.time - b.time);
  const after = sorted.find((key) => key.time >= time);
  const before = sorted.findLast((key) => key.time <= time);
  if (!before || !after) return (before ?? after)?.value ?? unkeyed;
  if (before.time === after.time) return before.value;
  return before.value + ((after.value - before.value) * (time - before.time)) / (after.time - before.time);
}
