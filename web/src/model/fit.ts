/**
 * Few keys for a focus that was recorded frame by frame: straight and smooth segments whose distances are off by a share at most.
 *
 * Knots are found from the first sample on, each as late as a cubic reaches (so do Schneider's curves, *Graphics Gems*, 1990). Then
 * values and slopes at all knots are fitted at once by least squares, whose weights turn towards the largest error (Lawson 1961), and
 * knots go for as long as the error stays within the tolerance.
 */

import { inverse } from "./distance";
import { solveSymmetric } from "./least_squares";
import type { Key } from "./keys";

/** A distance at a time. */
export interface Sample {
  /** USD time code. */
  readonly time: number;
  readonly distanceM: number;
}

export interface Fit {
  readonly keys: readonly Key[];
  /** Largest error, as a share of the distance. */
  readonly error: number;
}

/** A knot: a sample at which a key is, and whether the curve may turn sharply there. */
interface Knot {
  readonly at: number;
  readonly isCorner: boolean;
}

/** Values and slopes at a knot; m and m for each time code. */
interface Node {
  readonly time: number;
  readonly value: number;
  readonly inSlope: number;
  readonly outSlope: number;
}

/** Rounds in which the weights turn towards the largest error. */
const ROUNDS = 12;
/** Knots up to which all are fitted at once, and up to which those that are not needed are looked for. */
const [MOST_AT_ONCE, MOST_TRIED] = [64, 16];

/**
 * Few keys whose curve is within a tolerance of samples.
 *
 * Focus goes by the inverse of the distance, so that is what errors are of: near, by the same share of it; beyond `farM`, where all is
 * about as sharp, by that share of the inverse of `farM`.
 *
 * @param samples in the order of time, at least one; distances may be infinite.
 * @param tolerance share of the distance, above 0.
 * @param farM above 0.
 */
export function fitKeys(samples: readonly Sample[], tolerance: number, farM: number): Fit {
  const fitter = new Fitter(samples, tolerance, farM);
  return fitter.fit();
}

/** How far a distance is from what it is to be, as a share. */
export function errorOf(distanceM: number, wantedM: number, farM: number): number {
  if (!(distanceM > 0)) return Infinity;
  return Math.abs(inverse(distanceM) - inverse(wantedM)) / Math.max(inverse(wantedM), 1 / farM);
}

class Fitter {
  readonly #times: readonly number[];
  readonly #wanted: readonly number[];
  /** As they are fitted: infinity is the nearest distance that passes for it. */
  readonly #values: readonly number[];
  readonly #weights: readonly number[];
  readonly #tolerance: number;
  readonly #farM: number;

  constructor(samples: readonly Sample[], tolerance: number, farM: number) {
    [this.#tolerance, this.#farM] = [tolerance, farM];
    const most = (2 * farM) / tolerance;
    this.#times = samples.map(({ time }) => time);
    this.#wanted = samples.map(({ distanceM }) => distanceM);
    this.#values = this.#wanted.map((distanceM) => Math.min(distanceM, most));
    this.#weights = this.#values.map((value) => Math.min(1 / value, farM / (value * value)));
  }

  fit(): Fit {
    const last = this.#times.length - 1;
    const first = this.#wanted[0] ?? Infinity; // not as it is fitted, which passes for infinity but is none
    if (this.#wanted.every((_, at) => this.#errorAt(at, first) <= this.#tolerance * 1e-3)) {
      const error = largest(this.#wanted.map((_, at) => this.#errorAt(at, this.#value(0))));
      return { keys: [{ time: this.#time(0), value: this.#value(0), interpolation: "linear" }], error };
    }
    const ats = [0];
    while ((ats.at(-1) ?? last) < last) ats.push(this.#reach(ats.at(-1) ?? 0));
    return this.#keysOf(this.#fewest(ats));
  }

  #time(at: number): number {
    return this.#times[at] ?? 0;
  }

  #value(at: number): number {
    return this.#values[at] ?? 0;
  }

  #errorAt(at: number, value: number): number {
    return errorOf(value, this.#wanted[at] ?? Infinity, this.#farM);
  }

  /** The last sample that one segment reaches from another; at least the next. */
  #reach(from: number): number {
    const last = this.#times.length - 1;
    const holds = (to: number): boolean => this.#errorOfNodes([from, to], this.#segment(from, to)) <= this.#tolerance;
    let [good, step] = [Math.min(from + 1, last), 2];
    while (good < last && holds(Math.min(from + step, last))) {
      good = Math.min(from + step, last);
      step *= 2;
    }
    let bad = Math.min(from + step, last + 1);
    while (bad - good > 1) {
      const middle = (good + bad) >> 1;
      if (holds(middle)) good = middle;
      else bad = middle;
    }
    return good;
  }

  /** A segment through two samples whose slopes fit those between them. */
  #segment(from: number, to: number): readonly Node[] {
    const [start, length] = [this.#time(from), this.#time(to) - this.#time(from)];
    const [first, last] = [this.#value(from), this.#value(to)];
    let [aa, ab, bb, ac, bc] = [0, 0, 0, 0, 0];
    for (let at = from + 1; at < to; at += 1) {
      const [h00, h10, h01, h11] = hermite((this.#time(at) - start) / length);
      const weight = (this.#weights[at] ?? 0) ** 2;
      const rest = this.#value(at) - h00 * first - h01 * last;
      aa += weight * h10 * h10;
      ab += weight * h10 * h11;
      bb += weight * h11 * h11;
      ac += weight * h10 * rest;
      bc += weight * h11 * rest;
    }
    const chord = (last - first) / length;
    const found = aa * bb - ab * ab;
    const isFound = found > 1e-12 * aa * bb;
    const out = isFound ? (ac * bb - bc * ab) / found / length : chord;
    const into = isFound ? (aa * bc - ab * ac) / found / length : chord;
    return [
      { time: start, value: first, inSlope: out, outSlope: out },
      { time: start + length, value: last, inSlope: into, outSlope: into },
    ];
  }

  /** The fewest knots that are found among some, and the curve at them. */
  #fewest(ats: readonly number[]): readonly Node[] {
    let knots = ats.map((at): Knot => ({ at, isCorner: true }));
    let best = this.#through(ats);
    if (ats.length > MOST_AT_ONCE) return best;
    const take = (tried: readonly Knot[]): boolean => {
      const nodes = this.#solve(tried);
      if (this.#errorOfNodes(this.#ats(tried), nodes) > this.#tolerance) return false;
      [knots, best] = [[...tried], nodes];
      return true;
    };
    const smooth = (knot: Knot): Knot => ({ ...knot, isCorner: false });
    if (!take(knots.map(smooth)) && knots.length <= MOST_TRIED) {
      for (const at of ats) take(knots.map((knot) => (knot.at === at ? smooth(knot) : knot)));
    }
    if (knots.length > MOST_TRIED) return best;
    for (let place = knots.length - 2; place > 0; place -= 1) {
      const without = knots.filter((_, other) => other !== place);
      if (!take(without)) take(without.map((knot) => ({ ...knot, isCorner: true })));
    }
    return best;
  }

  #ats(knots: readonly Knot[]): number[] {
    return knots.map(({ at }) => at);
  }

  /** Segments that go through the samples at knots, each by itself. */
  #through(ats: readonly number[]): readonly Node[] {
    const segments = ats.slice(1).map((to, place) => this.#segment(ats[place] ?? 0, to));
    return ats.map((at, place): Node => {
      const [before, after] = [segments[place - 1]?.[1], segments[place]?.[0]];
      const [inSlope, outSlope] = [before?.inSlope ?? after?.outSlope ?? 0, after?.outSlope ?? before?.inSlope ?? 0];
      return { time: this.#time(at), value: this.#value(at), inSlope, outSlope };
    });
  }

  /** Values and slopes at knots that fit all samples. */
  #solve(knots: readonly Knot[]): readonly Node[] {
    let count = 0;
    const unknowns = knots.map(({ isCorner }) => {
      const [value, inSlope] = [count, count + 1];
      count += isCorner ? 3 : 2;
      return { value, inSlope, outSlope: count - 1 };
    });
    const rows = this.#rows(knots, unknowns);
    let lawson = rows.map(() => 1);
    let [best, least] = [null as readonly Node[] | null, Infinity];
    for (let round = 0; round < ROUNDS && least > this.#tolerance; round += 1) {
      const found = solveSymmetric(rows, lawson, count);
      const nodes = knots.map(({ at }, place): Node => {
        const of = unknowns[place];
        const at_ = (index: number | undefined): number => found[index ?? 0] ?? 0;
        return { time: this.#time(at), value: at_(of?.value), inSlope: at_(of?.inSlope), outSlope: at_(of?.outSlope) };
      });
      const errors = this.#errorsOf(this.#ats(knots), nodes);
      const error = largest(errors);
      if (error < least) [best, least] = [nodes, error];
      const most = Number.isFinite(error) ? error : 1;
      lawson = lawson.map((weight, at) => weight * (0.05 + Math.min((errors[at] ?? 0) / most, 1)));
    }
    return best ?? this.#through(this.#ats(knots));
  }

  /** One equation for each sample: its weight in the unknowns of the segment that it is in, and its value. */
  #rows(
    knots: readonly Knot[],
    unknowns: readonly { readonly value: number; readonly inSlope: number; readonly outSlope: number }[],
  ): { readonly terms: readonly (readonly [number, number])[]; readonly value: number }[] {
    let place = 0;
    return this.#values.map((value, at) => {
      while (place < knots.length - 2 && at > (knots[place + 1]?.at ?? 0)) place += 1;
      const [one, other] = [unknowns[place], unknowns[place + 1]];
      const [start, end] = [this.#time(knots[place]?.at ?? 0), this.#time(knots[place + 1]?.at ?? 0)];
      const length = end - start;
      const [h00, h10, h01, h11] = hermite((this.#time(at) - start) / length);
      const weight = this.#weights[at] ?? 0;
      const terms = [
        [one?.value ?? 0, weight * h00],
        [one?.outSlope ?? 0, weight * h10 * length],
        [other?.value ?? 0, weight * h01],
        [other?.inSlope ?? 0, weight * h11 * length],
      ] as const;
      return { terms, value: weight * value };
    });
  }

  #errorOfNodes(ats: readonly number[], nodes: readonly Node[]): number {
    return largest(this.#errorsOf(ats, nodes));
  }

  /** Errors of the samples from the first knot to the last. */
  #errorsOf(ats: readonly number[], nodes: readonly Node[]): number[] {
    const [first, last] = [ats[0] ?? 0, ats.at(-1) ?? 0];
    const errors: number[] = [];
    let place = 0;
    for (let at = first; at <= last; at += 1) {
      while (place < ats.length - 2 && at > (ats[place + 1] ?? 0)) place += 1;
      const [one, other] = [nodes[place], nodes[place + 1]];
      if (one && other) errors.push(this.#errorAt(at, curveAt(one, other, this.#time(at))));
    }
    return errors;
  }

  #keysOf(nodes: readonly Node[]): Fit {
    const isStraight = nodes.slice(1).map((after, place) => this.#isStraight(nodes[place] ?? after, after));
    const error = this.#errorOfNodes(
      nodes.map(({ time }) => this.#times.indexOf(time)),
      nodes,
    );
    const all = isStraight.every(Boolean);
    return { keys: nodes.map((node, place) => (all ? straightKey(node) : curvedKey(node, place, nodes))), error };
  }

  #isStraight(one: Node, other: Node): boolean {
    const chord = (other.value - one.value) / (other.time - one.time);
    const least = 1e-6 * Math.max(Math.abs(chord), (1e-3 * one.value) / (other.time - one.time));
    return Math.abs(one.outSlope - chord) <= least && Math.abs(other.inSlope - chord) <= least;
  }
}

/** The largest of errors, of which there may be more than a call takes arguments. */
function largest(errors: readonly number[]): number {
  return errors.reduce((most, error) => Math.max(most, error), 0);
}

function straightKey({ time, value }: Node): Key {
  return { time, value, interpolation: "linear" };
}

/** A key with handles of a third of the way to its neighbours, with which a Bezier curve is the cubic. */
function curvedKey({ time, value, inSlope, outSlope }: Node, place: number, nodes: readonly Node[]): Key {
  const [before, after] = [nodes[place - 1], nodes[place + 1]];
  const inWidth = before ? (time - before.time) / 3 : 0;
  const outWidth = after ? (after.time - time) / 3 : 0;
  return { time, value, interpolation: "bezier", tangents: { inSlope, inWidth, outSlope, outWidth } };
}

/** Weights of a cubic at a share of a segment: of the first value and slope, and of the last. */
function hermite(t: number): readonly [number, number, number, number] {
  const [square, cube] = [t * t, t * t * t];
  return [2 * cube - 3 * square + 1, cube - 2 * square + t, 3 * square - 2 * cube, cube - square];
}

function curveAt(one: Node, other: Node, time: number): number {
  const length = other.time - one.time;
  const [h00, h10, h01, h11] = hermite((time - one.time) / length);
  return h00 * one.value + h10 * length * one.outSlope + h01 * other.value + h11 * length * other.inSlope;
}
