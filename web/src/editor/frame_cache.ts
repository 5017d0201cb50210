/**
 * Frames that play at once, held to a budget of memory. A frame is of use for as long as its answer stays: after an edit the service
 * says which pictures have changed, and the others are kept.
 */

import { computed, effect, signal, type ReadonlySignal } from "@preact/signals";
import { frameCount, type FrameRange } from "../model/time";
import type { LivePicture } from "../net/live_link";
import { NewestWins } from "../net/newest";
import type { PictureStates, Service } from "../net/service";
import type { ShotDocument } from "./document";

/** Memory of all frames, bytes. */
export const MOST_BYTES = 256 * 2 ** 20;
/** Frames whose states are read at once. Of longer shots only those about the playhead are cached. */
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

/** What becomes of a picture: it is kept, or there is no room for it, or it is not one of the edits that are known here. */
export type Put = "kept" | "full" | "strange";

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
  readonly #read = signal<(Part & { readonly states: PictureStates }) | null>(null);
  readonly #reading: NewestWins<Part, PictureStates>;
  readonly #stop: () => void;
  /** What was asked for last. */
  #asked: Part | null = null;

  /** @param time of the playhead, about which the frames of long shots are cached. */
  constructor(service: Service, document: ShotDocument, time: ReadonlySignal<number>, mostBytes: number = MOST_BYTES) {
    this.#document = document;
    this.#mostBytes = mostBytes;
    this.#reading = new NewestWins({
      load: ({ start, end }, abort) => service.pictureStates(document.view, start, end, abort),
      onResult: (states, part) => {
        this.refusal.value = null;
        this.#read.value = { ...part, states };
        const { by } = states;
        this.#set([...this.#frames.peek()].filter(([at, { state }]) => !by.has(at) || by.get(at) === state));
      },
      onError: (error) => {
        this.#asked = null;
        this.refusal.value = error;
      },
      mostInFlight: 1,
    });
    const part = computed(() => partAbout(document.shot.range, time.value));
    this.#stop = effect(() => {
      const wanted = { revision: document.revision.value, ...part.value };
      const isUsed = this.isFilling.value || this.#frames.value.size > 0;
      const isBusy = document.pending.value > 0 || document.dragging.value;
      if (!isUsed || isBusy || isSame(wanted, this.#asked)) return;
      this.#asked = wanted;
      this.#reading.load(wanted, { disposable: true });
    });
  }

  /** What pictures depend on now; null until that is read. */
  readonly states = computed(() => {
    const read = this.#read.value;
    return read?.revision === this.#document.revision.value ? read.states.by : null;
  });

  /** Times whose picture is cached, and is that of the present edits. */
  readonly times = computed<readonly number[]>(() => {
    const states = this.states.value;
    return [...this.#frames.value].filter(([time, { state }]) => states?.get(time) === state).map(([time]) => time);
  });

  /** Those of them whose focus map is cached, too. */
  readonly mappedTimes = computed<readonly number[]>(() =>
    this.times.value.filter((time) => this.#frames.value.get(time)?.picture.focusMap !== null),
  );

  /** The cached picture of a time, where it is that of the present edits. */
  find(time: number): LivePicture | null {
    const frame = this.#frames.peek().get(time);
    return frame && this.states.peek()?.get(time) === frame.state ? frame.picture : null;
  }

  /**
   * Keeps a picture, in place of frames that are farther from a time.
   *
   * @param revision of the edits that it is of, as the service says it.
   * @param about time code.
   */
  put(time: number, picture: LivePicture, revision: string, about: number): Put {
    const state = this.states.peek()?.get(time);
    if (state === undefined || state === null || this.#read.peek()?.states.revision !== revision) return "strange";
    const others = [...this.#frames.peek()]
      .filter(([other]) => other !== time)
      .sort(([one], [other]) => Math.abs(one - about) - Math.abs(other - about));
    let bytes = others.reduce((sum, [, frame]) => sum + sizeOf(frame.picture), sizeOf(picture));
    while (bytes > this.#mostBytes) {
      const farthest = others.pop();
      if (!farthest || Math.abs(farthest[0] - about) <= Math.abs(time - about)) return "full";
      bytes -= sizeOf(farthest[1].picture);
    }
    this.#set([...others, [time, { picture, state }]]);
    return "kept";
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
    this.bytes.value = frames.reduce((sum, [, { picture }]) => sum + sizeOf(picture), 0);
  }
}

function sizeOf({ blob, focusMap }: LivePicture): number {
  return blob.size + (focusMap?.byteLength ?? 0);
}

/** The frames whose states are read: all of a shot, or of a long one those about a time, which change only now and then. */
function partAbout(range: FrameRange, time: number): { start: number; end: number } {
  const last = range.start + frameCount(range) - 1;
  if (frameCount(range) <= MOST_STATES) return { start: range.start, end: last };
  const step = MOST_STATES / 2;
  const start = range.start + step * Math.max(0, Math.round((time - range.start) / step) - 1);
  return { start, end: Math.min(start + MOST_STATES - 1, last) };
}

function isSame(one: Part, other: Part | null): boolean {
  return one.revision === other?.revision && one.start === other.start && one.end === other.end;
}
