/**
 * Values between keys, as USD's Bezier splines have them (OpenUSD, `pxr/base/ts`): held, linear or curved from a key to the next, and
 * held before the first and after the last.
 */

import type { Key, Tangents } from "./keys";

/** A curved segment in normal form: control points of a cubic Bezier, in time and value. */
type Controls = readonly [Place, Place, Place, Place];

export interface Place {
  /** USD time code. */
  readonly time: number;
  readonly value: number;
}

export type Side = "in" | "out";

/**
 * The tangents in effect at a key: its own, or those that USD gives an `auto` key (the "Auto Ease" of Maya). A straight or held key
 * that a curve leads to has a level one.
 *
 * @param keys in the order of time.
 */
export function tangentsAt(keys: readonly Key[], index: number): Required<Tangents> {
  const [key, before, after] = [keys[index], keys[index - 1], keys[index + 1]];
  const level = { inSlope: 0, inWidth: 0, outSlope: 0, outWidth: 0 };
  if (!key) return level;
  const [inThird, outThird] = [before ? (key.time - before.time) / 3 : 0, after ? (after.time - key.time) / 3 : 0];
  if (key.tangents && key.interpolation === "bezier") {
    const { inSlope = 0, inWidth = 0, outSlope = 0, outWidth = 0 } = key.tangents;
    return { inSlope, inWidth: inWidth || inThird, outSlope, outWidth: outWidth || outThird };
  }
  const isEased = key.interpolation === "auto" || key.interpolation === "bezier";
  const slope = isEased && before && after ? easedSlope(before, key, after) : 0;
  return { inSlope: slope, inWidth: inThird, outSlope: slope, outWidth: outThird };
}

/** A slope between those to the neighbours, nearer to that of the near one; 0 at an extreme, so that the curve never overshoots. */
function easedSlope(before: Place, key: Place, after: Place): number {
  const inSlope = (key.value - before.value) / (key.time - before.time);
  const outSlope = (after.value - key.value) / (after.time - key.time);
  if (inSlope * outSlope <= 0) return 0;
  const u = (key.time - before.time) / (after.time - before.time) - 0.5;
  const slope = inSlope + (0.5 + u * (0.5 + 2 * u * u)) * (outSlope - inSlope);
  return Math.sign(slope) * Math.min(Math.abs(slope), 3 * Math.abs(inSlope), 3 * Math.abs(outSlope));
}

/** The end of a handle; null for a key without handles, and where the curve on that side of it is straight or held. */
export function handleAt(keys: readonly Key[], index: number, side: Side): Place | null {
  const [key, other] = [keys[index], keys[side === "in" ? index - 1 : index + 1]];
  if (!key || !other || !isCurved(key) || !isCurved(side === "in" ? other : key)) return null;
  const tangents = tangentsAt(keys, index);
  if (side === "in")
    return { time: key.time - tangents.inWidth, value: key.value - tangents.inSlope * tangents.inWidth };
  return { time: key.time + tangents.outWidth, value: key.value + tangents.outSlope * tangents.outWidth };
}

/** The value at a time; null without keys. */
export function valueAt(keys: readonly Key[], time: number): number | null {
  const [first, last] = [keys[0], keys.at(-1)];
  if (!first || !last) return null;
  if (time <= first.time) return first.value;
  if (time >= last.time) return last.value;
  const index = keys.findLastIndex((key) => key.time <= time);
  const [before, after] = [keys[index] ?? first, keys[index + 1] ?? last];
  if (before.interpolation === "held") return before.value;
  if (!isCurved(before))
    return before.value + ((after.value - before.value) * (time - before.time)) / (after.time - before.time);
  const controls = controlsOf(keys, index, before, after);
  return bezier(controls, parameterAt(controls, time)).value;
}

/**
 * The keys to set for one more on a curve, which stays as it is: the new one, and those beside it where the curve between them is
 * curved, with shorter handles.
 */
export function insertion(keys: readonly Key[], time: number): Key[] {
  const value = valueAt(keys, time);
  const index = keys.findLastIndex((key) => key.time <= time);
  const [before, after] = [keys[index], keys[index + 1]];
  if (value === null) return [];
  if (!before || !after || !isCurved(before)) {
    const beside = before ?? after;
    return [{ time, value, interpolation: beside && !isCurved(beside) ? beside.interpolation : "auto" }];
  }
  const controls = controlsOf(keys, index, before, after);
  const t = parameterAt(controls, time);
  const [a, b, c, d] = controls;
  const [ab, bc, cd] = [between(a, b, t), between(b, c, t), between(c, d, t)];
  const [abc, bcd] = [between(ab, bc, t), between(bc, cd, t)];
  const [into, out] = [tangentsAt(keys, index), tangentsAt(keys, index + 1)];
  const at = between(abc, bcd, t);
  const own = {
    inSlope: slopeOf(abc, at),
    inWidth: at.time - abc.time,
    outSlope: slopeOf(at, bcd),
    outWidth: bcd.time - at.time,
  };
  const isBefore = { ...into, outSlope: slopeOf(a, ab), outWidth: ab.time - a.time };
  const isAfter = { ...out, inSlope: slopeOf(cd, d), inWidth: d.time - cd.time };
  const bezierKey = ({ time: at, value }: Place, tangents: Tangents): Key => ({
    time: at,
    value,
    interpolation: "bezier",
    tangents,
  });
  return [
    bezierKey(before, isBefore),
    bezierKey({ time, value }, own),
    ...(isCurved(after) ? [bezierKey(after, isAfter)] : []),
  ];
}

function between(a: Place, b: Place, t: number): Place {
  return { time: a.time + (b.time - a.time) * t, value: a.value + (b.value - a.value) * t };
}

function slopeOf(a: Place, b: Place): number {
  return b.time > a.time ? (b.value - a.value) / (b.time - a.time) : 0;
}

/**
 * Places along the curve that draw it, from the first key to the last.
 *
 * @param steps places in one curved segment.
 */
export function curveOf(keys: readonly Key[], steps: number): Place[] {
  const places: Place[] = [];
  for (const [index, before] of keys.entries()) {
    const after = keys[index + 1];
    places.push({ time: before.time, value: before.value });
    if (!after) break;
    if (before.interpolation === "held") places.push({ time: after.time, value: before.value });
    if (!isCurved(before)) continue;
    const controls = controlsOf(keys, index, before, after);
    for (let step = 1; step < steps; step += 1) places.push(bezier(controls, step / steps));
  }
  return places;
}

/** Whether the curve from a key to the next is curved. */
export function isCurved({ interpolation }: Key): boolean {
  return interpolation === "auto" || interpolation === "bezier";
}

function controlsOf(keys: readonly Key[], index: number, before: Key, after: Key): Controls {
  const { outSlope, outWidth } = tangentsAt(keys, index);
  const { inSlope, inWidth } = tangentsAt(keys, index + 1);
  const [out, into] = forwardWidths(outWidth, inWidth, after.time - before.time);
  return [
    before,
    { time: before.time + out, value: before.value + outSlope * out },
    { time: after.time - into, value: after.value - inSlope * into },
    after,
  ];
}

/** Share of the segment by which USD shortens handles, to be sure that time does not run backwards. */
const PADDING = 1e-5;

/** Widths of the handles of a segment at which time does not run backwards; they keep their ratio, as in USD. */
function forwardWidths(out: number, into: number, span: number): readonly [number, number] {
  const [a, b] = [out / span, into / span];
  const turns = (a > 1 || b > 1) && a * a + b * b + a * b - 2 * a - 2 * b + 1 > 0;
  if (!turns) return [out, into];
  if (a === 0) return [0, span];
  const ratio = b / a;
  const kept = (Math.sqrt(ratio) + ratio + 1) / (ratio * ratio + ratio + 1);
  return [(kept - PADDING) * span, (kept * ratio - PADDING) * span];
}

function bezier([a, b, c, d]: Controls, t: number): Place {
  const s = 1 - t;
  const weights = [s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t] as const;
  const mix = (of: (place: Place) => number): number =>
    weights[0] * of(a) + weights[1] * of(b) + weights[2] * of(c) + weights[3] * of(d);
  return { time: mix((place) => place.time), value: mix((place) => place.value) };
}

/** The parameter of a time, by bisection: time never runs backwards. */
function parameterAt(controls: Controls, time: number): number {
  let [low, high] = [0, 1];
  for (let step = 0; step < 52; step += 1) {
    const middle = (low + high) / 2;
    if (bezier(controls, middle).time < time) low = middle;
    else high = middle;
  }
  return (low + high) / 2;
}
