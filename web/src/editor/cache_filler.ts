/** Makes the frames of a cache one by one: all that are played where a person asks for them, else while nothing else is wanted. */

import { computed, effect, signal, type ReadonlySignal } from "@preact/signals";
import { cacheQuality, fittingEngine, restQuality, type CacheEngine } from "../model/quality";
import { isAbort } from "../net/errors";
import type { LivePicture } from "../net/live_link";
import type { Service } from "../net/service";
import type { ShotDocument } from "./document";
import type { Fail } from "./fail";
import type { FrameCache, Put } from "./frame_cache";
import type { Pictures } from "./pictures";
import type { Playhead } from "./playhead";

/** Rest before frames are made unasked, ms. */
const REST_MS = 2500;

/** Width of the focus maps of cached frames. */
const MAP_WIDTH_PX = 480;

/** Failures after which no more frames are made unasked before the next edit. */
const MOST_FAILURES = 3;

/** What the filler works for. */
export interface Player {
  readonly document: ShotDocument;
  readonly cache: FrameCache;
  readonly playhead: Pick<Playhead, "played" | "every" | "time">;
  /** The pictures on screen, by which the engine is chosen. */
  readonly pictures: Pick<Pictures, "displayed">;
  /** Whether nothing else is wanted: the best picture is on screen, and nothing moves. */
  readonly settled: ReadonlySignal<boolean>;
  /** Whether pictures come with focus maps: those of cached frames are cached then, too. */
  readonly focusMaps: ReadonlySignal<boolean>;
  /** Width over height of the picture. */
  readonly aspect: number;
}

export class CacheFiller {
  /** Whether a person has asked for all frames of what is played. */
  readonly asked = signal(false);
  /** Time of the frame that is being made. */
  readonly making = signal<number | null>(null);
  /** The engine that makes them; null until that is decided. */
  readonly engine = signal<CacheEngine | null>(null);
  /** Whether the memory is full. */
  readonly isFull = signal(false);
  readonly #service: Service;
  readonly #player: Player;
  readonly #fail: Fail;
  readonly #isRested = signal(false);
  /** Frames that could not be made, which are left out until the next edit. */
  readonly #failed = signal<ReadonlySet<number>>(new Set());
  readonly #stops: readonly (() => void)[];
  #flight: AbortController | null = null;
  #rest: ReturnType<typeof setTimeout> | undefined;

  constructor(service: Service, player: Player, fail: Fail) {
    [this.#service, this.#player, this.#fail] = [service, player, fail];
    const { cache, document, playhead } = player;
    this.#stops = [
      effect(() => {
        clearTimeout(this.#rest);
        this.#isRested.value = false;
        if (player.settled.value) this.#rest = setTimeout(() => (this.#isRested.value = true), REST_MS);
      }),
      effect(() => {
        const wants = this.#wants.value;
        cache.isFilling.value = wants;
        const next = wants ? this.#next.value : null;
        if (next === null) this.#flight?.abort();
        else if (this.making.value === null) void this.#make(next);
      }),
      effect(() => {
        if (this.asked.value && this.progress.value.missing === 0) this.asked.value = false;
      }),
      effect(() => {
        const refusal = cache.refusal.value;
        if (refusal !== null && this.asked.peek()) this.#complain(refusal);
      }),
      // What could not be made may be possible after an edit, and what was too much may have room elsewhere.
      document.revision.subscribe(() => {
        this.#failed.value = new Set();
      }),
      playhead.played.subscribe(() => {
        this.isFull.value = false;
      }),
      playhead.time.subscribe(() => {
        this.isFull.value = false;
      }),
    ];
  }

  /** Whether frames are to be made now. */
  readonly #wants = computed(() => {
    if (!this.#player.settled.value || this.isFull.value) return false;
    return this.asked.value || (this.#isRested.value && this.#failed.value.size < MOST_FAILURES);
  });

  /** Frames of what is played, those near the playhead first. */
  readonly #wanted = computed<readonly number[]>(() => {
    const { start, end } = this.#player.playhead.played.value;
    const times: number[] = [];
    for (let time = start; time <= end + 1e-6; time += this.#player.playhead.every.value) times.push(time);
    const about = this.#player.playhead.time.value + 0.25; // of two as near, the one that follows
    return times.sort((one, other) => Math.abs(one - about) - Math.abs(other - about));
  });

  /** Times of frames that are cached with all that is wanted. */
  readonly #cached = computed<readonly number[]>(() => {
    const { cache, focusMaps } = this.#player;
    return focusMaps.value ? cache.mappedTimes.value : cache.times.value;
  });

  /** The next frame to make; null where all are there, or where it is not known yet which are. */
  readonly #next = computed(() => {
    const states = this.#player.cache.states.value;
    const left = new Set([...this.#cached.value, ...this.#failed.value]);
    return this.#wanted.value.find((time) => !left.has(time) && isPossible(states, time) === true) ?? null;
  });

  /** How many frames of what is played are cached, of how many, and how many are missing that can be made. */
  readonly progress = computed(() => {
    const cached = new Set(this.#cached.value);
    const wanted = this.#wanted.value;
    const states = this.#player.cache.states.value;
    const failed = this.#failed.value;
    const missing = wanted.filter(
      (time) => !cached.has(time) && !failed.has(time) && isPossible(states, time) !== false,
    );
    return { cached: wanted.filter((time) => cached.has(time)).length, of: wanted.length, missing: missing.length };
  });

  /** Makes all frames of what is played, or no longer. */
  ask(all: boolean): void {
    this.isFull.value = false;
    if (all) this.#failed.value = new Set();
    this.asked.value = all;
    if (!all) this.#flight?.abort();
  }

  /** Forgets all frames, and how they were made. */
  clear(): void {
    this.ask(false);
    this.#isRested.value = false;
    this.engine.value = null;
    this.#player.cache.clear();
  }

  close(): void {
    for (const stop of this.#stops) stop();
    clearTimeout(this.#rest);
    this.#flight?.abort();
  }

  async #make(time: number): Promise<void> {
    const { revision } = this.#player.document;
    const [flight, before] = [new AbortController(), revision.peek()];
    [this.#flight, this.making.value] = [flight, time];
    try {
      const { picture, revision: madeOf } = await this.#frameAt(time, flight.signal);
      void this.#player.document.pointsAt(time).catch(() => undefined);
      if (flight.signal.aborted || revision.peek() !== before) return;
      this.#take(time, this.#player.cache.put(time, picture, madeOf, this.#player.playhead.time.peek()));
    } catch (error) {
      if (!isAbort(error)) this.#note(time, error);
    } finally {
      [this.#flight, this.making.value] = [null, null];
    }
  }

  /** Makes a frame, or the focus map that a cached one lacks. */
  async #frameAt(time: number, abort: AbortSignal): Promise<{ picture: LivePicture; revision: string }> {
    const { document, cache, pictures, focusMaps, aspect } = this.#player;
    const size = restQuality(MAP_WIDTH_PX, MAP_WIDTH_PX / aspect);
    const map = focusMaps.peek() ? await this.#service.focusMap(document.view, time, size, abort) : null;
    const there = map && cache.find(time);
    if (there) return { picture: { ...there, focusMap: map.data }, revision: map.revision };
    // With no frame left, none needs to be like those before.
    if (cache.bytes.peek() === 0) this.engine.value = null;
    const engine = (this.engine.value ??= fittingEngine(pictures.displayed.peek()));
    const began = performance.now();
    const quality = cacheQuality(engine, aspect);
    const { blob, revision } = await this.#service.cacheFrame(document.view, time, quality, engine, abort);
    const { width, height } = quality;
    const [rays, tookMs] = [engine === "lens" ? quality.rays : 0, performance.now() - began];
    const focusMap = map?.revision === revision ? map.data : null;
    return { picture: { blob, stage: "preview", width, height, rays, share: 0, tookMs, focusMap }, revision };
  }

  #take(time: number, put: Put): void {
    if (put === "full") [this.isFull.value, this.asked.value] = [true, false];
    // Somebody else has edited the shot: its edits are read, and then the states of its pictures.
    if (put !== "strange") return;
    this.#leaveOut(time);
    void this.#player.document.catchUp();
  }

  /** Leaves out a frame that could not be made; the person who asked for it is told of the first one. */
  #note(time: number, error: unknown): void {
    const isFirst = this.#failed.peek().size === 0;
    this.#leaveOut(time);
    if (!this.asked.peek()) return;
    const isTooMany = this.#failed.peek().size >= MOST_FAILURES;
    if (isTooMany) this.asked.value = false;
    if (isFirst) this.#complain(error);
  }

  #leaveOut(time: number): void {
    this.#failed.value = new Set([...this.#failed.peek(), time]);
  }

  #complain(error: unknown): void {
    this.#fail(error, () => {
      this.ask(true);
    });
  }
}

/** Whether the picture of a time can be made; null where that is not known yet. */
function isPossible(states: ReadonlyMap<number, string | null> | null, time: number): boolean | null {
  return states === null ? null : (states.get(time) ?? null) !== null;
}
