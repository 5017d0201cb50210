/** Takes: pulls that were recorded by hand, a distance for each frame. */

import { inverse } from "./distance";
import type { Sample } from "./fit";

export interface Take {
  /** Counts the takes of a shot from 1 on. */
  readonly number: number;
  /** Time code of the first frame. */
  readonly start: number;
  /** Inverse distances from the entrance pupil, 1/m, of the frames from the first one on; 0 is infinity. */
  readonly nearness: readonly number[];
}

/** Place of the ring at a moment of a recording. */
export interface Moment {
  /** USD time code, between frames too. */
  readonly time: number;
  readonly distanceM: number;
}

/** Most frames of a take, and digits of the nearness that are kept: finer than a ring is turned. */
const [MOST_FRAMES, DIGITS] = [100_000, 6];

/**
 * A take of the frames that moments of a recording are at and between; even in the inverse of the distance from a moment to the next.
 * Null where there is no frame among them.
 *
 * @param moments in the order of time.
 * @param origin a frame of the shot, from which frames count.
 */
export function takeOf(number: number, moments: readonly Moment[], origin: number): Take | null {
  const [first, last] = [moments[0], moments.at(-1)];
  if (!first || !last) return null;
  const start = origin + Math.ceil(first.time - origin - 1e-6);
  const count = Math.floor(last.time - start + 1e-6) + 1;
  if (count < 1 || count > MOST_FRAMES) return null;
  let place = 0;
  const nearness = Array.from({ length: count }, (_frame, at) => {
    while (place < moments.length - 2 && (moments[place + 1]?.time ?? Infinity) < start + at) place += 1;
    const before = moments[place] ?? first;
    const after = moments[place + 1] ?? before;
    const span = after.time - before.time;
    const share = span > 0 ? Math.min(Math.max((start + at - before.time) / span, 0), 1) : 1;
    const [one, other] = [inverse(before.distanceM), inverse(after.distanceM)];
    return Number((one + (other - one) * share).toFixed(DIGITS));
  });
  return { number, start, nearness };
}

/** The last frame of a take. */
export function endOf({ start, nearness }: Take): number {
  return start + nearness.length - 1;
}

/** The distances of a take, m. */
export function samplesOf({ start, nearness }: Take): Sample[] {
  return nearness.map((w, at) => ({ time: start + at, distanceM: w > 0 ? 1 / w : Infinity }));
}

/** What is kept of the pulls of a shot. */
export interface PullNotes {
  /** Distances of the numbered witness marks, m from the entrance pupil, by the number from 1 on; null for none. */
  readonly marks: readonly (number | null)[];
  readonly punchIn: number | null;
  readonly punchOut: number | null;
  readonly takes: readonly Take[];
}

export const MOST_MARKS = 9;
/** Takes that are kept of a shot; the oldest go. */
export const MOST_TAKES = 20;

export const NO_NOTES: PullNotes = { marks: [], punchIn: null, punchOut: null, takes: [] };

/** Reads notes that were kept as JSON; what cannot be read is left out. */
export function notesOf(json: unknown): PullNotes {
  const { marks, punchIn, punchOut, takes } = fieldsOf(json);
  const number = (value: unknown): number | null => (isFrame(value) ? value : null);
  return {
    marks: listOf(marks)
      .slice(0, MOST_MARKS)
      .map((mark) => (mark === "far" ? Infinity : isFrame(mark) && mark > 0 ? mark : null)),
    punchIn: number(punchIn),
    punchOut: number(punchOut),
    takes: listOf(takes).flatMap(takeIn).slice(-MOST_TAKES),
  };
}

/** Notes as they are kept as JSON, which has no infinity. */
export function keptNotes(notes: PullNotes): unknown {
  return { ...notes, marks: notes.marks.map((mark) => (mark === Infinity ? "far" : mark)) };
}

function takeIn(json: unknown): Take[] {
  const { number, start, nearness } = fieldsOf(json);
  const all = listOf(nearness);
  const isWhole = all.length > 0 && all.length <= MOST_FRAMES && all.every((w) => isFrame(w) && w >= 0);
  return isFrame(number) && isFrame(start) && isWhole ? [{ number, start, nearness: all as number[] }] : [];
}

function fieldsOf(json: unknown): Readonly<Record<string, unknown>> {
  return typeof json === "object" && json !== null ? (json as Readonly<Record<string, unknown>>) : {};
}

function listOf(json: unknown): readonly unknown[] {
  return Array.isArray(json) ? json : [];
}

function isFrame(value: unknown): value is number {
  return typeof value === "number" && Math.abs(value) <= 1e9;
}
