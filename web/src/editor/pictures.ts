/**
 * Keeps the picture on screen up with the time, the edits and what a hand is trying: at once with what can be had at once,
 * then better and better until the exact one. They come live; where that connection cannot be had they are asked for one by one.
 */

import { signal } from "@preact/signals";
import type { Changes } from "../model/changes";
import { draftQuality, type Quality } from "../model/quality";
import type { FocusPoint, Readout } from "../model/shot";
import { sameTime } from "../model/time";
import type { LiveLink, LivePicture, Wish } from "../net/live_link";
import { NewestWins } from "../net/newest";
import { Recent } from "../net/recent";
import type { Service } from "../net/service";
import type { ShotDocument } from "./document";

/** Pictures kept for playing again. */
const MOST_KEPT = 400;
/** Of the width at rest: a kept picture that is wider will do while things move. */
const GOOD_WIDTH = 0.45;
/** How long things must be still before a whole picture is asked for where it does not come live, ms. */
const SETTLE_MS = 400;

/** A picture on screen, with the points where they were at its time. */
export interface Displayed extends Omit<LivePicture, "blob"> {
  readonly bitmap: ImageBitmap;
  readonly time: number;
  readonly revision: number;
  /** That was asked for; the picture may be less. */
  readonly quality: Quality;
  readonly tried: Changes;
  readonly points: readonly FocusPoint[];
}

export interface WantedPicture extends Wish {
  readonly revision: number;
}

/** As it was asked for: the later one is the greater. */
interface Asked extends WantedPicture {
  readonly number: number;
}

interface Kept {
  readonly picture: LivePicture;
  readonly quality: Quality;
}

export class Pictures {
  readonly displayed = signal<Displayed | null>(null);
  /** Whether a better picture is on its way. */
  readonly busy = signal(false);
  /** Times whose picture is kept and can be played without the service. */
  readonly keptTimes = signal<readonly number[]>([]);

  readonly #document: ShotDocument;
  readonly #link: LiveLink;
  readonly #fetcher: NewestWins<Asked, LivePicture>;
  readonly #hearReadout: (readout: Readout, tried: Changes) => void;
  readonly #kept = new Recent<Kept>(MOST_KEPT);
  #isLive = true;
  #keptRevision = -1;
  #wanted: Asked | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #asked = 0;
  /** Of the newest that anything has come of. */
  #answered = 0;
  #serial = 0;
  #shownSerial = 0;

  constructor(service: Service, document: ShotDocument, fail: (error: unknown) => void) {
    this.#document = document;
    this.#hearReadout = (readout, tried) => {
      document.hearReadout(readout, tried);
    };
    this.#link = service.live(document.view, {
      onPicture: (picture, wish) => this.#take(picture, wish as Asked),
      onReadout: (readout, wish) => {
        this.#hearReadout(readout, wish.tried);
      },
      onError: (error) => {
        this.busy.value = false;
        fail(error);
      },
      onOpen: (isOpen) => {
        const was = this.#isLive;
        this.#isLive = isOpen;
        if (isOpen) this.#fetcher.clear();
        if (was !== isOpen && this.#wanted) this.#ask(this.#wanted);
      },
    });
    this.#fetcher = new NewestWins({
      load: async (wanted, signal) => {
        const quality = wanted.moving ? draftQuality(wanted.quality) : wanted.quality;
        const began = performance.now();
        const blob = await service.frame(document.view, wanted.time, quality, signal);
        const { width, height, rays } = quality;
        const stage = wanted.moving ? "preview" : "final";
        return { blob, stage, width, height, rays, share: wanted.moving ? 0 : 1, tookMs: performance.now() - began };
      },
      onResult: (picture, wanted) => void this.#take(picture, wanted),
      onError: (error) => {
        this.busy.value = false;
        fail(error);
      },
    });
  }

  /** Whether another picture would be made soon: what playing waits for. */
  get free(): boolean {
    return this.#isLive ? this.#link.free : this.#fetcher.free;
  }

  /** Asks for a picture, in place of what was wanted before. */
  want(picture: WantedPicture): void {
    if (this.#wanted && isSame(this.#wanted, picture) && (picture.moving || !this.#wanted.moving)) return;
    const wanted = { ...picture, number: (this.#asked += 1) };
    this.#wanted = wanted;
    const kept = this.#keptFor(wanted);
    if (kept) void this.#take(kept.picture, { ...wanted, quality: kept.quality });
    if (kept && (wanted.moving || kept.picture.stage === "final")) {
      // What is under way would only bring back what was wanted before.
      this.busy.value = false;
      clearTimeout(this.#timer);
      this.#link.forget();
      this.#fetcher.clear();
      return;
    }
    this.#ask(wanted);
  }

  close(): void {
    clearTimeout(this.#timer);
    this.#wanted = null;
    this.#link.close();
    this.#fetcher.clear();
    this.displayed.value?.bitmap.close();
    this.displayed.value = null;
  }

  #ask(wanted: Asked): void {
    clearTimeout(this.#timer);
    this.busy.value = !wanted.moving;
    if (this.#isLive) {
      this.#link.want(wanted);
      return;
    }
    // One that is asked for cannot be stopped half way, and what is only tried cannot be asked for at all.
    if (wanted.tried.length > 0) return;
    this.#fetcher.want({ request: { ...wanted, moving: true } });
    if (wanted.moving) return;
    this.#timer = setTimeout(() => {
      this.#fetcher.want({ request: wanted, disposable: true });
    }, SETTLE_MS);
  }

  /** Shows a picture, unless there is one that was asked for later, or a better one. Resolves when it is on screen. */
  async #take(picture: LivePicture, wanted: Asked): Promise<void> {
    this.#keep(picture, wanted);
    if (wanted.number < this.#answered) return;
    this.#answered = wanted.number;
    const serial = (this.#serial += 1);
    const { blob, ...said } = picture;
    const { time, revision, quality, tried } = wanted;
    const [bitmap, points] = await Promise.all([createImageBitmap(blob), this.#document.pointsAt(time)]);
    if (serial < this.#shownSerial || this.#wanted === null) {
      bitmap.close();
      return;
    }
    this.#shownSerial = serial;
    this.displayed.peek()?.bitmap.close();
    this.displayed.value = { ...said, bitmap, time, revision, quality, tried, points };
    if (said.stage === "final" && isSame(this.#wanted, wanted)) this.busy.value = false;
  }

  #keep(picture: LivePicture, { time, revision, quality, tried }: WantedPicture): void {
    if (tried.length > 0 || revision !== this.#document.revision.value) return;
    if (revision !== this.#keptRevision) {
      this.#kept.clear();
      this.#keptRevision = revision;
    }
    const before = this.#kept.get(time.toString());
    if (before && picture.stage !== "final" && before.picture.width > picture.width) return;
    this.#kept.set(time.toString(), { picture, quality });
    this.keptTimes.value = this.#kept.names().map(Number);
  }

  /** A kept picture that will do for what is wanted. */
  #keptFor({ time, revision, quality, tried, moving }: WantedPicture): Kept | null {
    const kept = revision === this.#keptRevision && tried.length === 0 ? this.#kept.get(time.toString()) : undefined;
    if (!kept) return null;
    const isWhole =
      kept.picture.stage === "final" && kept.quality.width === quality.width && kept.quality.motion === quality.motion;
    return isWhole || (moving && kept.picture.width >= GOOD_WIDTH * quality.width) ? kept : null;
  }
}

/** Whether two wishes are for the same picture, however good it is to be. */
function isSame(one: WantedPicture, other: WantedPicture): boolean {
  return (
    one.revision === other.revision &&
    sameTime(one.time, other.time) &&
    (one.tried === other.tried || (one.tried.length === 0 && other.tried.length === 0)) &&
    one.quality.width === other.quality.width &&
    one.quality.height === other.quality.height &&
    one.quality.motion === other.quality.motion
  );
}
