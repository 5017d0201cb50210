/** Playing: which frame is due when, and how many are really shown. */

import { frameCount, snapToFrame, type FrameRange } from "./time";

/** All frames are played, or every so manieth. */
export const EVERY: readonly number[] = [1, 2, 3, 4, 6, 8];

export const REPEATS = ["loop", "pingPong", "once"] as const;
/** What follows the last frame: the first one, the way back, or nothing. */
export type Repeat = (typeof REPEATS)[number];

export interface Playing {
  /** What is played, both ends included. */
  readonly range: FrameRange;
  readonly repeat: Repeat;
  /** Times the shot's rate; negative backwards. */
  readonly speed: number;
  /** Only every so many frames are shown, counted from the first, each for as long as so many. */
  readonly every: number;
}

/** A frame that is due. */
export interface Due {
  readonly time: number;
  /** Number of frames that were due before it, since playing began. */
  readonly index: number;
  /** Whether nothing follows. */
  readonly isLast: boolean;
}

/** Fastest play, times the shot's rate. */
export const MOST_SPEED = 8;

/**
 * The frame that is due so many seconds after playing began.
 *
 * It follows the clock and not the pictures, so a slow renderer drops frames and the shot still lasts as long as it should.
 */
export function frameDue({ range, repeat, speed, every }: Playing, from: number, seconds: number): Due {
  const [count, forward] = [Math.ceil(frameCount(range) / every), speed >= 0];
  const index = Math.floor((Math.abs(speed) * range.framesPerSecond * seconds) / every + 1e-6);
  const first = Math.floor((snapToFrame(range, from) - range.start) / every);
  const at = forward ? first + index : first - index;
  const isLast = repeat === "once" && (forward ? at >= count - 1 : at <= 0);
  return { time: range.start + every * placeOf(at, count, repeat), index, isLast };
}

/** Where a count that goes on and on is among so many frames. */
function placeOf(at: number, count: number, repeat: Repeat): number {
  if (repeat === "once" || count === 1) return Math.min(Math.max(at, 0), count - 1);
  const period = repeat === "loop" ? count : 2 * (count - 1);
  const within = ((at % period) + period) % period;
  return repeat === "loop" || within <= count - 1 ? within : period - within;
}

/** The time so many seconds after playing began, between frames too: the frame that is due has come at its start. */
export function timeDue({ range, repeat, speed }: Playing, from: number, seconds: number): number {
  const first = snapToFrame(range, from) - range.start;
  return range.start + placeOf(first + speed * range.framesPerSecond * seconds, frameCount(range), repeat);
}

/** The next speed of a shuttle that is pushed one way: twice as fast, or at the shot's rate where it went the other way or stood. */
export function shuttled(speed: number, way: 1 | -1): number {
  return speed * way > 0 ? way * Math.min(2 * Math.abs(speed), MOST_SPEED) : way;
}

/** What a viewer has seen since playing began. */
export interface Seen {
  /** Frames in a second, over the last ones; null until two were shown. */
  readonly rate: number | null;
  readonly dropped: number;
}

export const NOTHING_SEEN: Seen = { rate: null, dropped: 0 };

/** Span that the rate is taken over, ms. */
const RATE_MS = 2000;
/** Wait for a picture after which the rate is taken anew, ms. */
const LATE_MS = 500;

/** Counts the frames that are shown and those that were due before them and were not. */
export class PlayMeter {
  #asked: { readonly time: number; readonly index: number }[] = [];
  #shown = 0;
  #last = -1;
  #at: number[] = [];

  /** A frame is requested that is due as the given one. */
  ask({ time, index }: Due): void {
    this.#asked.push({ time, index });
  }

  /** A frame is on screen; returns what was seen so far, or null for a frame that was not asked for. */
  show(time: number, nowMs: number): Seen | null {
    const found = this.#asked.findIndex((asked) => asked.time === time);
    const asked = this.#asked[found];
    if (!asked || asked.index <= this.#last) return null;
    this.#asked = this.#asked.slice(found + 1);
    this.#last = asked.index;
    this.#shown += 1;
    this.#at = [...this.#at.filter((at) => nowMs - at <= RATE_MS), nowMs];
    const [first = nowMs] = this.#at;
    const rate = nowMs > first ? (1000 * (this.#at.length - 1)) / (nowMs - first) : null;
    return { rate, dropped: asked.index + 1 - this.#shown };
  }

  /** What was seen where no picture has come for longer than a frame may take, while one is due; null where one has. */
  late(due: Due, nowMs: number): Seen | null {
    const last = this.#at.at(-1);
    if (last === undefined || nowMs - last < LATE_MS) return null;
    const recent = this.#at.filter((at) => nowMs - at <= RATE_MS);
    return { rate: (1000 * recent.length) / RATE_MS, dropped: due.index - this.#shown };
  }
}
