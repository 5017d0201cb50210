/**
 * Frames that play at once, held to a budget of memory. A frame is of use for as long as its answer stays: after an edit the service
 * says which pictures have changed, and the others are kept.
 */

import { computed, effect, signal, type ReadonlySignal } from "@preact/signals";
import { frameCount, type FrameRange } from "../model/time";
import type { LivePicture } from "../net/live_link";
import { NewestWins } from "../net/newest";
import type { Service } from "../net/service";
import type { ShotDocument } from "./document";

/** Memory of all frames, bytes. */
export const MOST_BYTES = 256 * 2 ** 20;
/** Shots of up to this many frames are asked about as a whole. */
const MOST_STATES = 500;

interface CachedFrame {
  readonly picture: LivePicture;
  /** What the picture depends on, as the service says it. */
  readonly state: string;
}

/** A part of the shot at a revision of the document. */
interface Part {
  readonly revision: number;
  readonly start: number;
  readonly end: number;
}

/** What the pictures of a part depend on, by time. */
interface States extends Part {
  readonly by: ReadonlyMap<number, string | null>;
}

export class FrameCache {
  /** Whether frames will be cached, so that their states are read. */
  readonly isFilling = signal(false);
  /** Memory of all frames, bytes. */
  readonly bytes = signal(0);
  /** The error for which no states can be read; null where they can. */
  readonly refusal = signal<unknown>(null);
  readonly #document: ShotDocument;
  readonly #mostBytes: number;
  readonly #frames = signal<ReadonlyMap<number, CachedFrame>>(new Map());
  readonly #read = signal<States | null>(null);
  readonly #reading: NewestWins<Part, ReadonlyMap<number, string | null>>;
  readonly #stop: () => void;

  /** @param range what is played, of long shots the part whose frames are cached. */
  constructor(
    service: Service,
    document: ShotDocument,
    range: ReadonlySignal<FrameRange>,
    mostBytes: number = MOST_BYTES,
  ) {
    this.#document = document;
    this.#mostBytes = mostBytes;
    this.#reading = new NewestWins({
      load: ({ start, end }, abort) => service.pictureStates(document.view, start, end, abort),
      onResult: (by, part) => {
        this.refusal.value = null;
        this.#read.value = { ...part, by };
        this.#set([...this.#frames.peek()].filter(([time, { state }]) => !by.has(time) || by.get(time) === state));
      },
      onError: (error) => (this.refusal.value = error),
      mostInFlight: 1,
    });
    const whole = document.shot.range;
    this.#stop = effect(() => {
      const { start, end } = frameCount(whole) <= MOST_STATES ? whole : range.value;
      const part = { revision: document.revision.value, start, end };
      const isUsed = this.isFilling.value || this.#frames.value.size > 0;
      const isBusy = document.pending.value > 0 || document.dragging.value;
      if (isUsed && !isBusy && !isSame(part, this.#read.peek())) this.#reading.load(part);
    });
  }

  /** What pictures depend on now; null until that is read. */
  readonly states = computed(() => {
    const read = this.#read.value;
    return read?.revision === this.#document.revision.value ? read.by : null;
  });

  /** Times whose picture is cached, and is that of the present edits. */
  readonly times = computed<readonly number[]>(() => {
    const states = this.states.value;
    return [...this.#frames.value].filter(([time, { state }]) => states?.get(time) === state).map(([time]) => time);
  });

  /** The cached picture of a time, where it is that of the present edits. */
  find(time: number): LivePicture | null {
    const frame = this.#frames.peek().get(time);
    return frame && this.states.peek()?.get(time) === frame.state ? frame.picture : null;
  }

  /**
   * Keeps a picture of the present edits, in place of frames that are farther from a time. Returns whether there is room for it.
   *
   * @param about time code.
   */
  put(time: number, picture: LivePicture, about: number): boolean {
    const state = this.states.peek()?.get(time);
    if (state === undefined || state === null) return false;
    const byDistance = [...this.#frames.peek()]
      .filter(([other]) => other !== time)
      .sort(([one], [other]) => Math.abs(one - about) - Math.abs(other - about));
    const kept = [...byDistance, [time, { picture, state }] as const];
    let bytes = kept.reduce((sum, [, frame]) => sum + frame.picture.blob.size, 0);
    while (bytes > this.#mostBytes) {
      const farthest = byDistance.pop();
      if (!farthest || Math.abs(farthest[0] - about) <= Math.abs(time - about)) return false;
      bytes -= farthest[1].picture.blob.size;
    }
    this.#set([...byDistance, [time, { picture, state }]]);
    return true;
  }

  clear(): void {
    this.#set([]);
  }

  close(): void {
    this.#stop();
    this.#reading.clear();
    this.clear();
  }

  #set(frames: readonly (readonly [number, CachedFrame])[]): void {
    this.#frames.value = new Map(frames);
    this.bytes.value = frames.reduce((sum, [, { picture }]) => sum + picture.blob.size, 0);
  }
}

function isSame(one: Part, other: Part | null): boolean {
  return one.revision === other?.revision && one.start === other.start && one.end === other.end;
}
