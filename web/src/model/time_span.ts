/** The part of a shot's time that the timeline shows. */

import type { FrameRange } from "./time";

export interface TimeSpan {
  /** USD time codes. */
  readonly start: number;
  readonly end: number;
}

/** Shortest part that is shown, frames. */
const LEAST = 6;
/** Share of the part that is free on both sides of what is framed. */
const AIR = 0.1;

export function wholeOf({ start, end }: FrameRange): TimeSpan {
  return { start, end };
}

/**
 * A part about a time that stays where it is.
 *
 * @param factor of the length: below 1 shows less.
 */
export function zoomed(range: FrameRange, span: TimeSpan, factor: number, about: number): TimeSpan {
  const length = span.end - span.start;
  const wanted = Math.max(length * factor, LEAST);
  const share = length > 0 ? (about - span.start) / length : 0;
  return heldIn(range, about - share * wanted, wanted);
}

/** A part as long, so many frames later. */
export function panned(range: FrameRange, span: TimeSpan, frames: number): TimeSpan {
  return heldIn(range, span.start + frames, span.end - span.start);
}

/** The part that has all of some times, with some air beside them; the whole shot for none. */
export function framing(range: FrameRange, times: readonly number[]): TimeSpan {
  if (times.length === 0) return wholeOf(range);
  const [first, last] = [Math.min(...times), Math.max(...times)];
  const length = Math.max((last - first) * (1 + 2 * AIR), LEAST);
  return heldIn(range, (first + last - length) / 2, length);
}

/** A part as long that has a time: the same where it has it already. */
export function containing(range: FrameRange, span: TimeSpan, time: number): TimeSpan {
  if (time >= span.start && time <= span.end) return span;
  const length = span.end - span.start;
  return heldIn(range, time < span.start ? time - AIR * length : time - (1 - AIR) * length, length);
}

/** A part within the shot; the whole of it where it would be longer. */
function heldIn(range: FrameRange, start: number, length: number): TimeSpan {
  if (length >= range.end - range.start - 1e-6) return wholeOf(range);
  const held = Math.min(Math.max(start, range.start), range.end - length);
  return { start: held, end: held + length };
}
