/** Where in time the person is, and playing. */

import { computed, signal, type ReadonlySignal, type Signal } from "@preact/signals";
import { frameDue, NOTHING_SEEN, PlayMeter, shuttled, timeDue, type Repeat, type Seen } from "../model/playback";
import { snapToFrame, stepFrames, type FrameRange } from "../model/time";

export class Playhead {
  readonly range: FrameRange;
  readonly time: Signal<number>;
  readonly playing = signal(false);
  /** A person holds the scrubber. */
  readonly scrubbing = signal(false);
  /** First and last frame that are played; null for those of the shot. */
  readonly first = signal<number | null>(null);
  readonly last = signal<number | null>(null);
  readonly repeat = signal<Repeat>("loop");
  /** Only every so many frames are played. */
  readonly every = signal(1);
  /** Times the shot's rate, while playing; negative backwards. */
  readonly speed = signal(1);
  /** What the last or present playing has shown. */
  readonly seen = signal<Seen>(NOTHING_SEEN);
  /** What is played. */
  readonly played = computed<FrameRange>(() => ({
    ...this.range,
    start: this.first.value ?? this.range.start,
    end: this.last.value ?? this.range.end,
  }));
  readonly #isFree: (time: number) => boolean;
  #request = 0;
  /** The time that is due at a moment of the clock, ms; null where nothing plays. */
  #due: ((nowMs: number) => number) | null = null;
  #meter = new PlayMeter();
  /** Time of the picture on screen. */
  #onScreen: number | null = null;

  /** @param isFree whether the picture of a time can be had at once; else playing drops the frame. */
  constructor(range: FrameRange, time: number, isFree: (time: number) => boolean) {
    this.range = range;
    this.#isFree = isFree;
    this.time = signal(snapToFrame(range, time));
  }

  goTo(time: number): void {
    this.pause();
    this.time.value = snapToFrame(this.range, time);
  }

  step(frames: number): void {
    this.pause();
    this.time.value = stepFrames(this.range, this.time.value, frames);
  }

  /** Plays from this frame on, or no frame before; a limit that the other one lies beyond goes. */
  markFirst(time: number | null): void {
    this.first.value = time === null ? null : snapToFrame(this.range, time);
    if (time !== null && (this.last.value ?? time) < time) this.last.value = null;
    this.#playOn();
  }

  /** As `markFirst`, for the last frame. */
  markLast(time: number | null): void {
    this.last.value = time === null ? null : snapToFrame(this.range, time);
    if (time !== null && (this.first.value ?? time) > time) this.first.value = null;
    this.#playOn();
  }

  setRepeat(repeat: Repeat): void {
    this.repeat.value = repeat;
    this.#playOn();
  }

  setEvery(frames: number): void {
    this.every.value = frames;
    this.#playOn();
  }

  toggle(): void {
    if (this.playing.value) this.pause();
    else this.play();
  }

  /** Plays faster each time that it is pushed the same way, as J and L on a deck. */
  shuttle(way: 1 | -1): void {
    this.play(shuttled(this.playing.value ? this.speed.value : 0, way));
  }

  /** Plays, or goes on at another speed. */
  play(speed = 1): void {
    const range = this.played.value;
    if (range.end <= range.start) {
      this.pause();
      return;
    }
    cancelAnimationFrame(this.#request); // no pause: at rest, the best picture would be requested
    this.speed.value = speed;
    this.playing.value = true;
    this.seen.value = NOTHING_SEEN;
    this.#meter = new PlayMeter();
    const { repeat, every } = this;
    const playing = { range, repeat: repeat.value, every: every.value, speed };
    const from = this.#start(playing.repeat, speed);
    let index = -1;
    let started: number | null = null;
    const tick = (now: number): void => {
      const began = (started ??= now);
      this.#due = (nowMs) => timeDue(playing, from, Math.max(nowMs - began, 0) / 1000);
      const due = frameDue(playing, from, (now - started) / 1000);
      if (due.index > index && (due.time === this.time.value || this.#isFree(due.time))) {
        index = due.index;
        this.#meter.ask(due);
        if (due.time === this.#onScreen) this.#count(due.time);
        this.time.value = due.time;
      }
      this.seen.value = this.#meter.late(due, now) ?? this.seen.peek();
      if (due.isLast && due.time === this.time.value) this.pause();
      else this.#request = requestAnimationFrame(tick);
    };
    this.#request = requestAnimationFrame(tick);
  }

  pause(): void {
    cancelAnimationFrame(this.#request);
    this.#due = null;
    this.playing.value = false;
  }

  /** The time that is due by the clock, between frames too; while nothing plays, that of the playhead. */
  get due(): number {
    return this.#due?.(performance.now()) ?? this.time.peek();
  }

  /** Counts the pictures that come on screen while it plays. */
  watch(displayed: ReadonlySignal<{ readonly time: number } | null>): void {
    displayed.subscribe((shown) => {
      this.#onScreen = shown?.time ?? null;
      if (shown !== null && this.playing.peek()) this.#count(shown.time);
    });
  }

  #count(shown: number): void {
    this.seen.value = this.#meter.show(shown, performance.now()) ?? this.seen.peek();
  }

  /** Where playing begins: at the other end where nothing would follow, and within what is played. */
  #start(repeat: Repeat, speed: number): number {
    const { start, end } = this.played.value;
    const time = this.time.value;
    const isAtEnd = repeat === "once" && (speed > 0 ? time >= end : time <= start);
    if (isAtEnd || time < start || time > end) return speed > 0 ? start : end;
    return time;
  }

  /** Goes on with what was changed while it plays. */
  #playOn(): void {
    if (this.playing.value) this.play(this.speed.value);
  }
}
