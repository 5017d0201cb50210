/** The focus ring: where the focus of the shot has it, or a hand that has taken it. */

import { computed, effect, signal, type ReadonlySignal } from "@preact/signals";
import type { Changes } from "../model/changes";
import { sampleAt } from "../model/curve";
import { distanceAt, drawnTo, held, ringOf, turnAt } from "../model/ring";
import type { ShotDocument } from "./document";
import type { Playhead } from "./playhead";

/** Time after the last turn at which the picture shows the saved focus again, ms. */
const REST_MS = 1500;
/** Time in which a ring that eases to a place comes by all but a third, ms: steps of a coarse controller become one move. */
const EASE_MS = 50;
/** Turn that is as good as none. */
const ARRIVED = 1e-4;

/** Choices about the ring. */
export interface RingChoices {
  readonly snaps: ReadonlySignal<"on" | "off">;
  readonly follows: ReadonlySignal<"on" | "off">;
}

export class FocusRing {
  /** Counts the turns by hand. */
  readonly turns = signal(0);
  /** Turns of the marks that may draw it. */
  readonly marks: ReadonlySignal<readonly number[]>;
  /** Whether a hand keeps the ring though the playhead moves. */
  readonly isKept = signal(false);
  readonly #document: ShotDocument;
  readonly #playhead: Playhead;
  readonly #choices: RingChoices;
  readonly #hand = signal<number | null>(null);
  /** Where the hand is, which marks have not drawn. */
  #drawn: number | null = null;
  #easing: { target: number; request: number; last: number } | null = null;
  /** What the picture shows of it; null for nothing. */
  #shown: Changes | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;
  readonly #stop: () => void;

  /** @param marks distances of the marks, m. */
  constructor(
    document: ShotDocument,
    playhead: Playhead,
    choices: RingChoices,
    marks: ReadonlySignal<readonly (number | null)[]>,
  ) {
    [this.#document, this.#playhead, this.#choices] = [document, playhead, choices];
    this.marks = computed(() => {
      const ring = this.scale.value;
      return ring ? marks.value.flatMap((mark) => (mark === null ? [] : [turnAt(ring, mark)])) : [];
    });
    const release = playhead.time.subscribe(() => {
      if (!this.isKept.peek()) this.letGo();
    });
    const rest = effect(() => {
      if (!this.isKept.value) this.#restSoon();
    });
    this.#stop = () => {
      release();
      rest();
    };
  }

  /** The ring of the lens; null where it has none. */
  readonly scale = computed(() => {
    const readout = this.#document.readout.value;
    return readout && this.#document.hasLens ? ringOf(readout) : null;
  });

  /** Whether a hand has turned it away from the focus of the shot. */
  readonly isByHand = computed(() => this.#hand.value !== null);

  /** Where it stands, 0 at the close focus to 1 at infinity. */
  readonly turn = computed(() => this.#hand.value ?? this.#ofShot.value);

  /** Distance from the entrance pupil that it focuses on, m. */
  readonly distanceM = computed(() => {
    const ring = this.scale.value;
    return ring ? distanceAt(ring, this.turn.value) : Infinity;
  });

  readonly #ofShot = computed(() => {
    const [ring, readout] = [this.scale.value, this.#document.readout.value];
    const sample = sampleAt(this.#document.curve.value, this.#playhead.time.value);
    const distanceM = this.#playhead.playing.value && sample ? sample.focusDistanceM : readout?.focusDistanceM;
    return ring && distanceM !== undefined ? turnAt(ring, distanceM) : 1;
  });

  /** Turns it by as much as a hand has. */
  turnBy(by: number): void {
    this.#easeNoMore();
    this.#set((this.#drawn ?? this.turn.peek()) + by);
  }

  /** Turns it on in a moment, as a wheel or a key that goes in coarse steps. */
  easeBy(by: number): void {
    this.easeTo((this.#easing?.target ?? this.#drawn ?? this.turn.peek()) + by);
  }

  /** Turns it to a place in a moment, as a device that tells its place in coarse steps. */
  easeTo(turn: number): void {
    if (this.#easing) {
      this.#easing.target = held(turn);
      return;
    }
    const easing = { target: held(turn), request: 0, last: performance.now() };
    this.#easing = easing;
    const step = (): void => {
      const now = performance.now();
      const at = this.#drawn ?? this.turn.peek();
      const left = easing.target - at;
      const isThere = Math.abs(left) <= ARRIVED;
      this.#set(isThere ? easing.target : at + left * (1 - Math.exp((easing.last - now) / EASE_MS)));
      easing.last = now;
      if (isThere) this.#easing = null;
      else easing.request = requestAnimationFrame(step);
    };
    easing.request = requestAnimationFrame(step);
  }

  /** Gives it back to the focus of the shot. */
  letGo(): void {
    this.#easeNoMore();
    this.#drawn = null;
    this.#hand.value = null;
    this.#endPreview();
  }

  close(): void {
    this.letGo();
    this.#stop();
  }

  #set(turn: number): void {
    if (!this.scale.peek()) return;
    this.#drawn = held(turn);
    this.#hand.value = this.#choices.snaps.peek() === "on" ? drawnTo(this.marks.peek(), this.#drawn) : this.#drawn;
    this.turns.value += 1;
    this.#preview();
  }

  #easeNoMore(): void {
    if (this.#easing) cancelAnimationFrame(this.#easing.request);
    this.#easing = null;
  }

  /** Shows the focus of the hand in the picture, where it is to follow. */
  #preview(): void {
    const document = this.#document;
    const isFree = this.#isShown || (!document.dragging.peek() && document.pending.peek() === 0);
    if (this.#choices.follows.peek() === "off" || document.noEdits.peek() !== null || !isFree) return;
    const distanceM = this.distanceM.peek();
    const values = { focusDistanceM: Number.isFinite(distanceM) ? distanceM : 0 };
    this.#shown = [
      { type: "setFocus", values: { mode: "manual" } },
      { type: "setCamera", values },
    ];
    document.preview(this.#shown);
    this.#restSoon();
  }

  get #isShown(): boolean {
    return this.#shown !== null && this.#document.unsaved.peek() === this.#shown;
  }

  #restSoon(): void {
    clearTimeout(this.#timer);
    if (this.#shown === null || this.isKept.peek()) return;
    this.#timer = setTimeout(() => {
      this.#endPreview();
    }, REST_MS);
  }

  #endPreview(): void {
    clearTimeout(this.#timer);
    if (this.#isShown) this.#document.endPreview();
    this.#shown = null;
  }
}
