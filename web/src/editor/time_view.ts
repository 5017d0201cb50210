/** Which part of the shot's time the timeline shows. It follows the playhead. */

import { computed, effect, signal } from "@preact/signals";
import { containing, framing, panned, wholeOf, zoomed } from "../model/time_span";
import type { Playhead } from "./playhead";

/** Zoom for each press of a key. */
const KEY_ZOOM = 1.5;

export class TimeView {
  readonly span;
  readonly isWhole;
  readonly #playhead: Playhead;

  constructor(playhead: Playhead) {
    this.#playhead = playhead;
    const { range } = playhead;
    this.span = signal(wholeOf(range));
    this.isWhole = computed(() => this.span.value.end - this.span.value.start >= range.end - range.start);
    effect(() => {
      const time = playhead.time.value;
      this.span.value = containing(range, this.span.peek(), time);
    });
  }

  /**
   * Shows less or more, about a time that stays where it is.
   *
   * @param factor of what is shown: below 1 shows less.
   * @param about time code; the playhead where it is left out.
   */
  zoom(factor: number, about = this.#playhead.time.peek()): void {
    this.span.value = zoomed(this.#playhead.range, this.span.peek(), factor, about);
  }

  /** Shows less about the playhead, as by a press of a key. */
  zoomIn(): void {
    this.zoom(1 / KEY_ZOOM);
  }

  /** Shows more about the playhead. */
  zoomOut(): void {
    this.zoom(KEY_ZOOM);
  }

  /** Shows what is so many frames later. */
  pan(frames: number): void {
    this.span.value = panned(this.#playhead.range, this.span.peek(), frames);
  }

  /** Shows all of some times; the whole shot for none. */
  frame(times: readonly number[]): void {
    this.span.value = framing(this.#playhead.range, times);
  }
}
