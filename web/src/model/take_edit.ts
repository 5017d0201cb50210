/** The edit that makes a take the focus of the shot. */

import { FAR_AWAY_M, setFocusMode, type Change, type Changes } from "./changes";
import type { Curve } from "./curve";
import { fitKeys, type Fit, type Sample } from "./fit";
import { MOST_CHANGES } from "./key_lanes";
import type { Key, Tangents } from "./keys";
import type { FocusMode } from "./shot";
import { insertion, isCurved, tangentsAt, valueAt } from "./spline";
import { endOf, samplesOf, type Take } from "./take";
import type { FrameRange } from "./time";

const SETTING = "focusDistanceM" as const;

/** The focus before a take. */
export interface FocusBefore {
  readonly mode: FocusMode;
  /** Keys of the camera's focus distance, in the order of time. */
  readonly keys: readonly Key[];
  /** The focus as it is solved. */
  readonly curve: Curve;
  readonly range: FrameRange;
}

/** A take with few keys. */
export interface Simplified extends Fit {
  readonly take: Take;
}

/** Fits few keys to a take. */
export function simplify(take: Take, tolerance: number, farM: number): Simplified {
  return { take, ...fitKeys(samplesOf(take), tolerance, farM) };
}

/**
 * The changes that make keys the focus of the frames of their take; what is before and after it stays as it was. A focus that was found
 * otherwise is set by hand from then on, and gets keys of its own before and after.
 *
 * @param tolerance share of the distance by which the keys of a focus that was found otherwise are off at most.
 * @param farM as in `fitKeys`.
 */
export function applyTake({ take, keys }: Simplified, before: FocusBefore, tolerance: number, farM: number): Changes {
  const [start, end] = [take.start, endOf(take)];
  const taken = heldTo(keys, end);
  if (before.mode === "manual" && before.keys.length > 0) return among(before.keys, taken, start, end, before.range);
  const outside = (isOutside: (time: number) => boolean): readonly Key[] => {
    const samples = before.curve.filter(({ time }) => isOutside(time));
    const distances = samples.map(({ time, focusDistanceM: distanceM }): Sample => ({ time, distanceM }));
    return samples.length > 0 ? fitKeys(distances, tolerance, farM).keys : [];
  };
  const [head, tail] = [outside((time) => time < start - 0.5), outside((time) => time > end + 0.5)];
  const [only] = head;
  const held = only && head.length === 1 ? [{ ...only, time: start - 1 }] : head;
  return [...setFocusMode("manual", before.mode), ...whole([...held, ...taken, ...tail])];
}

/** Makes keys all that there are of the focus. */
function whole(keys: readonly Key[]): Changes {
  const [first] = keys;
  if (!first) return [];
  const clear: Change = { type: "setCamera", values: { [SETTING]: sent(first.value) } }; // for all time: keys go
  return [clear, ...keys.map(keyed)];
}

/** Keys of which one that stands for all frames is at the last of them, too: what follows does not change them. */
function heldTo(keys: readonly Key[], end: number): readonly Key[] {
  const [only] = keys;
  return only && keys.length === 1 && only.time < end - 1e-4 ? [only, { ...only, time: end }] : keys;
}

/** Keys among those before, of which those of the frames from `start` to `end` go. */
function among(
  before: readonly Key[],
  keys: readonly Key[],
  start: number,
  end: number,
  { start: first, end: last }: FrameRange,
): Changes {
  const isIn = (time: number): boolean => time > start - 1 + 1e-4 && time < end + 1 - 1e-4;
  // The curve beside the take keeps its shape: by a key on the frame before and the one after, and handles that neighbours leave alone.
  const still: readonly Key[] = before.map((key, at) => withHandles(key, before, at));
  const edges = [start - 1, end + 1].filter((time) => time >= first && time <= last);
  const edged = edges.reduce((all, time) => (hasKey(all, time) ? all : withKeys(all, insertionOf(all, time))), still);
  const kept = edged.filter(({ time }) => !isIn(time));
  const outside = asBefore(withKeys(kept, keys), new Map(still.map((key, at) => [key, before[at] ?? key])), isIn);
  const gone = before.filter(({ time }) => isIn(time));
  const set = withKeys(
    outside.filter((key) => !before.includes(key)),
    keys,
  );
  const changes = [
    ...gone.map(({ time }): Change => ({ type: "unkeySetting", setting: SETTING, time })),
    ...set.map(keyed),
  ];
  return changes.length <= MOST_CHANGES ? changes : whole(withKeys(outside, keys));
}

/** A key with the handles in effect; after the last key the focus is held. */
function withHandles(key: Key, keys: readonly Key[], at: number): Key {
  if (!isCurved(key)) return key;
  const tangents = tangentsAt(keys, at);
  return {
    ...key,
    interpolation: "bezier",
    tangents: at === keys.length - 1 ? { ...tangents, outSlope: 0 } : tangents,
  };
}

/**
 * The keys outside a take, each as it was before where its curve on their side is the same.
 *
 * @param own keys as they were, by those with handles.
 */
function asBefore(keys: readonly Key[], own: ReadonlyMap<Key, Key>, isIn: (time: number) => boolean): readonly Key[] {
  const before = keys.map((key) => own.get(key) ?? key);
  return keys.flatMap((key, at) => {
    if (isIn(key.time)) return [];
    const [one, other] = [tangentsAt(keys, at), tangentsAt(before, at)];
    const [left, right] = [keys[at - 1], keys[at + 1]];
    const isSame = (name: keyof Tangents): boolean => Math.abs(one[name] - other[name]) < 1e-9;
    const isSameIn = !left || isIn(left.time) || !isCurved(left) || (isSame("inSlope") && isSame("inWidth"));
    const isSameOut = !right || isIn(right.time) || !isCurved(key) || (isSame("outSlope") && isSame("outWidth"));
    return [isSameIn && isSameOut ? (before[at] ?? key) : key];
  });
}

/** The keys to set for one more; beyond the first and the last one, too. */
function insertionOf(keys: readonly Key[], time: number): readonly Key[] {
  const [first, last] = [keys[0], keys.at(-1)];
  if (first && last && (time < first.time || time > last.time)) {
    return [{ time, value: valueAt(keys, time) ?? first.value, interpolation: "linear" }];
  }
  return insertion(keys, time);
}

function withKeys(keys: readonly Key[], set: readonly Key[]): readonly Key[] {
  return [...keys.filter(({ time }) => !hasKey(set, time)), ...set].toSorted((a, b) => a.time - b.time);
}

function hasKey(keys: readonly Key[], time: number): boolean {
  return keys.some((key) => Math.abs(key.time - time) < 1e-4);
}

function keyed(key: Key): Change {
  return { type: "keySetting", setting: SETTING, key: { ...key, value: sent(key.value) } };
}

/** One far away stands for infinity. */
function sent(value: number): number {
  return Math.min(value, FAR_AWAY_M);
}
