/** Where in time the person is, and playing. */

import { signal, type Signal } from "@preact/signals";
import { playheadAt, snapToFrame, stepFrames, type FrameRange } from "../model/time";

export class Playhead {
  readonly range: FrameRange;
  readonly time: Signal<number>;
  readonly playing = signal(false);
  /** A person holds the scrubber. */
  readonly scrubbing = signal(false);
  readonly #isFree: () => boolean;
  #request = 0;

  /** @param isFree whether a picture can be requested at once; else playing skips the frame. */
  constructor(range: FrameRange, time: number, isFree: () => boolean) {
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

  toggle(): void {
    if (this.playing.value) this.pause();
    else this.play();
  }

  play(): void {
    if (this.playing.value || this.range.end <= this.range.start) return;
    this.playing.value = true;
    const from = this.time.value;
    const started = performance.now();
    const tick = (now: number): void => {
      const time = playheadAt(this.range, from, Math.max(0, now - started) / 1000);
      if (time !== this.time.value && this.#isFree()) this.time.value = time;
      this.#request = requestAnimationFrame(tick);
    };
    this.#request = requestAnimationFrame(tick);
  }

  pause(): void {
    cancelAnimationFrame(this.#request);
    this.playing.value = false;
  }
}
