/**
 * Pulling focus: what a click changes. Focus goes to the weighted mean of the points' inverse depths, so that a rack is two weights
 * that cross.
 */

import type { Key, Tangents } from "./keys";
import { keysOf, type Ease, type FocusPoint } from "./shot";
import { insertion, tangentsAt, valueAt } from "./spline";
import { nearestTime, sameTime, type FrameRange } from "./time";

/**
 * What a click means.
 *
 * `from`: the focus is there at the time of the click and stays. Until some frames before it is where it was, and it goes over in
 * between. What takes the focus over later does so as before. `shot`: for the whole shot. `frame`: at this frame, and between it and
 * the keys on both sides the focus drifts.
 */
export const REACHES = ["from", "shot", "frame"] as const;
export type Reach = (typeof REACHES)[number];

export interface Pull {
  readonly reach: Reach;
  /** Frames in which the focus goes over. */
  readonly frames: number;
  readonly ease: Ease;
}

/** The weight of a point over the shot: its keys, or without them one value. */
export interface Weight {
  readonly keys: readonly Key[];
  readonly value: number;
}

/** Times of a pull: the focus goes over from the first to the second and stays up to the third; null is the end of the shot. */
export interface PullSpan {
  readonly start: number;
  readonly arrival: number;
  readonly held: number | null;
}

/** Slopes of an ease where it starts and where it ends, as a cubic from (0, 0) to (1, 1). */
const END_SLOPES: Readonly<Record<Ease, readonly [number, number]>> = {
  linear: [1, 1],
  smooth: [0, 0],
  in: [0, 2],
  out: [2, 0],
};
const NONE: Weight = { keys: [], value: 0 };

export function weightOf(point: FocusPoint): Weight {
  return { keys: keysOf(point, "weight"), value: point.settings.weight };
}

/**
 * The weights that change by a pull.
 *
 * @param name the point that is to be sharp; it may be new and not yet among `points`.
 * @param time of the click.
 */
export function pulledWeights(
  name: string,
  time: number,
  points: readonly FocusPoint[],
  pull: Pull,
  range: FrameRange,
): Map<string, Weight> {
  const found = points.find((point) => point.name === name);
  const own = found && counts(found) ? weightOf(found) : NONE;
  const others = rivalsOf(name, points);
  const rivals = new Map(others.map((point) => [point.name, weightOf(point)]));
  if (pull.reach === "frame") return pulledAt(name, time, own, rivals, range);
  if (!found && rivals.size === 0) return new Map([[name, { keys: [], value: 1 }]]);
  if (pull.reach === "shot")
    return new Map([
      [name, { keys: [], value: 1 }],
      ...[...rivals.keys()].map((rival): [string, Weight] => [rival, NONE]),
    ]);
  const span = { start: startOf(time, pull, range), arrival: time, ...handoverAfter(time, others) };
  const before = [own, ...rivals.values()].reduce((sum, weight) => sum + weightAt(weight, span.start), 0);
  const changed = [...rivals]
    .filter(([, weight]) => hasSay(weight, span))
    .map(([rival, weight]): [string, Weight] => [rival, bend(weight, span, 0, pull.ease)]);
  return new Map([[name, bend(own, span, before > 0 ? before : 1, pull.ease)], ...changed]);
}

/** The times of a pull, for drawing it before it is made; null where it has none of its own. */
export function pullSpan(
  name: string | null,
  time: number,
  points: readonly FocusPoint[],
  pull: Pull,
  range: FrameRange,
): PullSpan | null {
  if (pull.reach === "frame") return { start: time, arrival: time, held: time };
  const rivals = rivalsOf(name, points);
  if (pull.reach === "shot" || rivals.length === 0) return { start: range.start, arrival: range.start, held: null };
  return { start: startOf(time, pull, range), arrival: time, held: handoverAfter(time, rivals).held };
}

/** When the focus begins to go over: no hand turns the ring in no time. */
export function startOf(time: number, { frames }: Pull, range: FrameRange): number {
  return Math.max(range.start, time - Math.max(frames, 1));
}

/** The other points that count at some time. */
function rivalsOf(name: string | null, points: readonly FocusPoint[]): FocusPoint[] {
  return points.filter(
    (point) =>
      point.name !== name && counts(point) && (keysOf(point, "weight").length > 0 || point.settings.weight > 0),
  );
}

/** Times of the next handover: when the focus leaves what it is on, and when it is elsewhere; null where it stays. */
interface Handover {
  readonly held: number | null;
  readonly next: number | null;
}

function handoverAfter(time: number, rivals: readonly FocusPoint[]): Handover {
  const times = rivals.flatMap((point) =>
    [...keysOf(point, "weight"), ...keysOf(point, "enabled")].map((key) => key.time),
  );
  const later = times.filter((at) => at > time && !sameTime(at, time)).sort((one, other) => one - other);
  const isAs = (at: number): boolean => rivals.every((point) => Math.abs(sayOf(point, at) - sayOf(point, time)) < 1e-6);
  const next = later.find((at) => !isAs(at)) ?? null;
  const held = next === null ? null : (later.findLast((at) => at < next && !sameTime(at, next)) ?? time);
  return { held, next };
}

/** Weight of a point where it is switched on, else 0. */
function sayOf(point: FocusPoint, time: number): number {
  const isOn = weightAt({ keys: keysOf(point, "enabled"), value: Number(point.settings.enabled) }, time) > 0;
  return isOn ? weightAt(weightOf(point), time) : 0;
}

function weightAt({ keys, value }: Weight, time: number): number {
  return valueAt(keys, time) ?? value;
}

/** Whether a weight is above 0 anywhere while a pull goes over and stays. */
function hasSay(weight: Weight, { start, held }: PullSpan): boolean {
  const [first, last] = [start - 1e-4, (held ?? Infinity) + 1e-4];
  const within = weight.keys.filter((key) => key.time >= first && key.time <= last).map((key) => key.value);
  return [weightAt(weight, start), weightAt(weight, held ?? start), ...within].some((value) => value > 1e-9);
}

/** A weight that goes to a level, stays there, and then goes over to what it is at the next handover. */
function bend(weight: Weight, span: PullSpan & Handover, level: number, ease: Ease): Weight {
  const { start, arrival, held, next } = span;
  const split = [start, ...(next === null ? [] : [next])].reduce(withKey, weight.keys);
  const [first, last] = [weightAt(weight, start), next === null ? level : weightAt(weight, next)];
  const isGradual = arrival > start && !sameTime(arrival, start);
  const corners: Key[] = isGradual ? [corner(start, first)] : [];
  corners.push(corner(arrival, level));
  if (held !== null && !sameTime(held, arrival)) corners.push(corner(held, level));
  const eased = isGradual ? crossed(corners, ease) : corners;
  const before = split.filter((key) => key.time < start && !sameTime(key.time, start));
  const upTo = joined(before, eased, split, start);
  if (next === null) return { ...weight, keys: reaching(upTo) };
  const after = split.filter((key) => key.time > next && !sameTime(key.time, next));
  return { ...weight, keys: reaching([...upTo, goalAt(split, next, last), ...after]) };
}

/** The key at a handover, which goes on as it did and is come to level. */
function goalAt(split: readonly Key[], time: number, value: number): Key {
  const index = split.findIndex((key) => sameTime(key.time, time));
  const key = split[index];
  if (!key) return corner(time, value);
  if (key.interpolation !== "auto" && key.interpolation !== "bezier") return { ...key, value };
  return { time, value, interpolation: "bezier", tangents: { ...tangentsAt(split, index), inSlope: 0, inWidth: 0 } };
}

/** Keys whose handles without a width reach a third of the way to their neighbours. */
function reaching(keys: readonly Key[]): Key[] {
  return keys.map((key, at) => {
    const { tangents } = key;
    if (!tangents) return key;
    const third = (other: Key | undefined): number => (other ? Math.abs(other.time - key.time) / 3 : 0);
    const { inWidth = 0, outWidth = 0 } = tangents;
    const reach = {
      inWidth: inWidth > 0 ? inWidth : third(keys[at - 1]),
      outWidth: outWidth > 0 ? outWidth : third(keys[at + 1]),
    };
    return { ...key, tangents: { ...tangents, ...reach } };
  });
}

/** Keys up to a time, and new ones from there on; the first of these goes on as the curve came. */
function joined(before: readonly Key[], corners: readonly Key[], split: readonly Key[], start: number): Key[] {
  const index = split.findIndex((key) => sameTime(key.time, start));
  const [first, ...rest] = corners;
  if (index <= 0 || !first?.tangents || !sameTime(first.time, start)) return [...before, ...corners];
  const { inSlope, inWidth } = tangentsAt(split, index);
  return [...before, { ...first, tangents: { ...first.tangents, inSlope, inWidth } }, ...rest];
}

function corner(time: number, value: number): Key {
  const tangents: Tangents = { inSlope: 0, inWidth: 0, outSlope: 0, outWidth: 0 };
  return { time, value, interpolation: "bezier", tangents };
}

/** Corners of which the first two are joined by an ease. */
function crossed([first, second, ...rest]: readonly Key[], ease: Ease): Key[] {
  if (!first || !second) return first ? [first] : [];
  const mean = (second.value - first.value) / (second.time - first.time);
  const [out, into] = END_SLOPES[ease].map((slope) => slope * mean);
  const leaving = { ...first, tangents: { ...first.tangents, outSlope: out ?? 0 } as Tangents };
  const coming = { ...second, tangents: { ...second.tangents, inSlope: into ?? 0 } as Tangents };
  return [leaving, coming, ...rest];
}

/** Keys with one more on the curve, which stays as it is. */
function withKey(keys: readonly Key[], time: number): readonly Key[] {
  if (keys.length === 0 || keys.some((key) => sameTime(key.time, time))) return keys;
  const set = insertion(keys, time);
  const others = keys.filter((key) => !set.some((one) => sameTime(one.time, key.time)));
  return [...others, ...set].sort((one, other) => one.time - other.time);
}

/**
 * The weights after a pull at one frame: the point gets weight 1 there and the others 0. At the neighbouring times where another
 * point has a key, or at the ends of the shot, this point keeps what it had, so that the focus there stays as it was.
 */
function pulledAt(
  name: string,
  time: number,
  own: Weight,
  rivals: ReadonlyMap<string, Weight>,
  { start, end }: FrameRange,
): Map<string, Weight> {
  const others = [...rivals].map(([rival, weight]): [string, Weight] => {
    const ends = [start, end].map((at) => ({ time: at, value: weight.value }));
    return [rival, weight.keys.length > 0 ? weight : { ...weight, keys: ends.reduce(withValue, weight.keys) }];
  });
  const decided = others.flatMap(([, { keys }]) => keys.map((key) => key.time));
  const beside = ([-1, 1] as const).map((side) =>
    nearestTime(
      decided.filter((at) => (at - time) * side > 0 && !sameTime(at, time)),
      time,
    ),
  );
  const handOver = beside.filter((at): at is number => at !== null && !keyedBetween(own.keys, at, time));
  const elsewhere = own.keys.length > 0 ? 0 : own.value;
  const set = [...handOver.map((at) => ({ time: at, value: elsewhere })), { time, value: 1 }];
  const off = others.filter(([, weight]) => weightAt(weight, time) > 0);
  return new Map([
    [name, { ...own, keys: set.reduce(withValue, own.keys) }],
    ...off.map(([rival, weight]): [string, Weight] => [
      rival,
      { ...weight, keys: withValue(weight.keys, { time, value: 0 }) },
    ]),
  ]);
}

/** Keys with a value at a time; a key that is there keeps its interpolation. */
function withValue(keys: readonly Key[], { time, value }: { time: number; value: number }): readonly Key[] {
  const interpolation = keys.find((key) => sameTime(key.time, time))?.interpolation ?? "auto";
  const others = keys.filter((key) => !sameTime(key.time, time));
  return [...others, { time, value, interpolation }].sort((one, other) => one.time - other.time);
}

/** A point that is off now and is never switched on does not pull, and is left alone. */
function counts(point: FocusPoint): boolean {
  return point.settings.enabled || keysOf(point, "enabled").length > 0;
}

/** Whether a point itself already has a say at `edge`, or between it and `time`. */
function keyedBetween(own: readonly Key[], edge: number, time: number): boolean {
  const [low, high] = edge < time ? [edge, time] : [time, edge];
  return own.some((key) => !sameTime(key.time, time) && key.time >= low - 1e-4 && key.time <= high + 1e-4);
}

/** Names of the values of points, which no point may have. */
const RESERVED = [
  ...["target", "face", "fanTriangle", "barycentric", "instance", "topology", "offset", "kind", "blur", "weight"],
  ...["falloff", "enabled", "surfaceOffset", "extent", "part", "boundsPoint"],
];
/** Longest stem of a name: with its number it is within what the service takes. */
const MOST_LETTERS = 90;

/** A name for a focus point that none has: the target's own, made an identifier, or with the first number that is free: `lamp_2`. */
export function freshName(target: string, others: readonly string[]): string {
  const taken = [...others, ...RESERVED];
  const letters = target.replace(/[^A-Za-z0-9_]/g, "_").replace(/^(?=\d)/, "_");
  const stem = letters.slice(0, MOST_LETTERS) || "focus";
  if (!taken.includes(stem)) return stem;
  for (let number = 2; ; number += 1) {
    const name = `${stem}_${number.toString()}`;
    if (!taken.includes(name)) return name;
  }
}
