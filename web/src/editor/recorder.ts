/** Records the focus ring while the shot plays. */

import { effect, signal, type ReadonlySignal } from "@preact/signals";
import { endOf, takeOf, type Moment, type PullNotes, type Take } from "../model/take";
import type { FocusRing } from "./focus_ring";
import type { Playhead } from "./playhead";

/** Whether it waits for the ring or the punch-in, or records. */
export type Recording = "off" | "armed" | "recording";

/** Speeds at which the shot plays while it records, times its own. */
export const SPEEDS = [1, 0.5, 0.25] as const;

/** Time that plays before the punch-in, seconds of the shot. */
const PRE_ROLL_S = 1;

/** First frame and last one that are recorded. */
interface Span {
  readonly start: number;
  readonly end: number;
}

export class Recorder {
  readonly state = signal<Recording>("off");
  readonly speed = signal<number>(1);
  readonly #playhead: Playhead;
  readonly #ring: FocusRing;
  readonly #notes: ReadonlySignal<PullNotes>;
  readonly #onTake: (take: Take) => void;
  readonly #onRefused: () => void;
  readonly #stop: () => void;
  #moments: Moment[] = [];
  /** Turns by hand when it was armed. */
  #turns = 0;
  /** The time that was played last, when that was by the clock, and the speed. */
  #seen: { readonly time: number; readonly ms: number; readonly speed: number } = { time: 0, ms: 0, speed: 1 };
  #request = 0;

  /** @param onRefused called where nothing can be recorded, since no frame from the punch-in to the punch-out is played. */
  constructor(
    playhead: Playhead,
    ring: FocusRing,
    notes: ReadonlySignal<PullNotes>,
    onTake: (take: Take) => void,
    onRefused: () => void,
  ) {
    [this.#playhead, this.#ring, this.#notes] = [playhead, ring, notes];
    [this.#onTake, this.#onRefused] = [onTake, onRefused];
    this.#stop = effect(() => {
      if (!playhead.playing.value) this.#finish();
    });
  }

  /** Plays, and records from the punch-in on, or without one from when the ring is turned. Returns whether it does. */
  arm(): boolean {
    if (this.state.peek() !== "off") return false;
    const [span, { range, played }] = [this.#span, this.#playhead];
    if (!span) {
      this.#onRefused();
      return false;
    }
    const isPunched = this.#notes.peek().punchIn !== null;
    const now = this.#playhead.time.peek();
    const from = now >= span.end ? span.start : now;
    const rolled = span.start - Math.round(PRE_ROLL_S * range.framesPerSecond);
    this.#ring.letGo();
    this.#playhead.goTo(Math.max(isPunched ? rolled : from, played.peek().start));
    this.#moments = [];
    this.#turns = this.#ring.turns.peek();
    this.#ring.isKept.value = true;
    this.state.value = "armed";
    this.#playhead.play(this.speed.peek());
    this.#see(this.#playhead.time.peek());
    this.#request = requestAnimationFrame(this.#tick);
    return true;
  }

  /** Ends the recording, which is a take then. */
  stop(): void {
    this.#finish();
  }

  /** Ends the recording for good; what was recorded is a take. */
  close(): void {
    this.#finish();
    this.#stop();
  }

  readonly #tick = (): void => {
    const [time, reach, before, span] = [this.#playhead.due, this.#reach, this.#seen.time, this.#span];
    const isOn = time >= before - 1e-6 && time <= reach && this.#playhead.speed.peek() === this.#seen.speed;
    if (this.state.peek() === "armed") {
      if (!span) this.#onRefused();
      if (!span) this.#finish();
      else if (isOn && this.#isBegun(time, span)) {
        this.state.value = "recording";
        this.#add(this.#notes.peek().punchIn === null ? time : Math.max(span.start, before));
      }
    }
    if (this.state.peek() === "recording") {
      // A step back is the end, where what is played is over; else somebody plays on from elsewhere or another way.
      const isPastEnd = isOn ? time >= this.#end : time < before && reach >= this.#playhead.played.peek().end;
      if (isOn || isPastEnd) this.#add(isPastEnd ? this.#end : time);
      if (!isOn || isPastEnd) this.#finish();
    }
    this.#see(time);
    if (this.state.peek() !== "off") this.#request = requestAnimationFrame(this.#tick);
  };

  #isBegun(time: number, { start, end }: Span): boolean {
    const isMoved = this.#ring.turns.peek() !== this.#turns;
    return time < end && (this.#notes.peek().punchIn === null ? isMoved : time >= start);
  }

  /** The frames from the punch-in to the punch-out that are played; null for none. */
  get #span(): Span | null {
    const [start, end] = [
      Math.max(this.#notes.peek().punchIn ?? -Infinity, this.#playhead.played.peek().start),
      this.#end,
    ];
    return start < end ? { start, end } : null;
  }

  /** Last frame that is recorded. */
  get #end(): number {
    return Math.min(this.#notes.peek().punchOut ?? Infinity, this.#playhead.played.peek().end);
  }

  /** The latest time that can be played by now, by the clock, and a frame. */
  get #reach(): number {
    const { time, ms, speed } = this.#seen;
    return time + ((performance.now() - ms) / 1000) * Math.abs(speed) * this.#playhead.range.framesPerSecond + 1;
  }

  #see(time: number): void {
    this.#seen = { time, ms: performance.now(), speed: this.#playhead.speed.peek() };
  }

  /** Adds a moment, unless it is not after the last one. */
  #add(time: number): void {
    if (time <= (this.#moments.at(-1)?.time ?? -Infinity)) return;
    this.#moments.push({ time, distanceM: this.#ring.distanceM.peek() });
  }

  #finish(): void {
    const before = this.state.peek();
    if (before === "off") return;
    this.state.value = "off";
    cancelAnimationFrame(this.#request);
    const time = this.#playhead.time.peek();
    if (before === "recording" && time <= this.#reach) this.#add(Math.min(time, this.#end)); // it was played to its end
    this.#playhead.pause();
    this.#ring.isKept.value = false;
    if (before !== "recording") return;
    const number = Math.max(0, ...this.#notes.peek().takes.map((take) => take.number)) + 1;
    const take = takeOf(number, this.#moments, this.#playhead.range.start);
    if (!take) return;
    this.#onTake(take);
    this.#playhead.goTo(endOf(take));
  }
}
