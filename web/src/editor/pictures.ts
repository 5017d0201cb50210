/** Keeps the picture on screen up with the time and the edits: a quick one while things move, the best one at rest. */

import { signal } from "@preact/signals";
import { FIRST_RUNG, movingQuality, nextRung, type Quality } from "../model/quality";
import type { FocusPoint } from "../model/shot";
import { sameTime } from "../model/time";
import { NewestWins } from "../net/newest";
import { Recent } from "../net/recent";
import type { Service } from "../net/service";
import type { ShotDocument } from "./document";

/**
 * How long things must be still before the best picture is asked for, ms: a part of what it takes, since the service
 * cannot stop one that it has begun and the next click would wait for it.
 */
const SETTLE_MS = { least: 120, most: 1500, part: 0.25 };
/** A best picture that comes this fast needs no quick one before it, ms. */
const QUICK_MS = 180;

/** Pictures kept for playing again. */
const MOST_KEPT = 400;

/** A picture on screen, with the points where they were at its time. */
export interface Displayed {
  readonly bitmap: ImageBitmap;
  readonly time: number;
  readonly revision: number;
  readonly quality: Quality;
  readonly best: boolean;
  readonly points: readonly FocusPoint[];
}

interface WantedPicture {
  readonly time: number;
  readonly revision: number;
  readonly quality: Quality;
}

interface FrameRequest extends WantedPicture {
  readonly best: boolean;
}

interface Kept {
  readonly blob: Blob;
  readonly quality: Quality;
  readonly best: boolean;
}

export class Pictures {
  readonly displayed = signal<Displayed | null>(null);
  readonly busy = signal(false);
  /** Times whose picture is kept and can be played without the service. */
  readonly keptTimes = signal<readonly number[]>([]);

  readonly #service: Service;
  readonly #document: ShotDocument;
  readonly #fetcher: NewestWins<FrameRequest, Displayed>;
  readonly #kept = new Recent<Kept>(MOST_KEPT);
  #keptRevision = -1;
  #rung = FIRST_RUNG;
  #bestTookMs = 2 * QUICK_MS;
  #timer: ReturnType<typeof setTimeout> | undefined;

  constructor(service: Service, document: ShotDocument, fail: (error: unknown) => void) {
    this.#service = service;
    this.#document = document;
    this.#fetcher = new NewestWins({
      load: (request, signal) => this.#load(request, signal),
      onResult: (picture) => {
        this.#show(picture);
      },
      onError: fail,
      onBusy: (busy) => (this.busy.value = busy),
    });
  }

  /** Whether another picture would be asked for at once: what playing waits for. */
  get free(): boolean {
    return this.#fetcher.free;
  }

  /** Asks for a picture: at rest the wanted one, while things move one that comes in time. */
  want(wanted: WantedPicture, moving: boolean): void {
    clearTimeout(this.#timer);
    const { time, revision } = wanted;
    const best: FrameRequest = { ...wanted, best: true };
    if (!moving && (this.#isKept(best) || this.#bestTookMs < QUICK_MS)) {
      this.#fetcher.want({ request: best, disposable: true });
      return;
    }
    if (moving || !this.#shows(time, revision)) {
      const quality = movingQuality(wanted.quality, this.#rung);
      this.#fetcher.want({ request: { time, revision, quality, best: false } });
    }
    if (moving) return;
    const settle = Math.min(Math.max(this.#bestTookMs * SETTLE_MS.part, SETTLE_MS.least), SETTLE_MS.most);
    this.#timer = setTimeout(() => {
      this.#fetcher.want({ request: best, disposable: true });
    }, settle);
  }

  close(): void {
    clearTimeout(this.#timer);
    this.#fetcher.clear();
    this.displayed.value?.bitmap.close();
    this.displayed.value = null;
  }

  #shows(time: number, revision: number): boolean {
    const shown = this.displayed.peek();
    return shown !== null && shown.revision === revision && sameTime(shown.time, time);
  }

  async #load(request: FrameRequest, signal: AbortSignal): Promise<Displayed> {
    const { time, revision } = request;
    const kept = this.#isKept(request) ? this.#kept.get(time.toString()) : undefined;
    const started = performance.now();
    const [blob, points] = await Promise.all([
      kept?.blob ?? this.#service.frame(this.#document.view, time, request.quality, signal),
      this.#document.pointsAt(time),
    ]);
    if (!kept) {
      this.#learn(request, performance.now() - started);
      this.#keep(request, blob);
    }
    const { quality, best } = kept ?? request;
    return { bitmap: await createImageBitmap(blob), time, revision, quality, best, points };
  }

  /** Fits what is asked for to how fast the service is. */
  #learn(request: FrameRequest, tookMs: number): void {
    if (request.best) this.#bestTookMs = tookMs;
    else this.#rung = nextRung(this.#rung, tookMs);
  }

  #keep(request: FrameRequest, blob: Blob): void {
    if (request.revision !== this.#document.revision.value) return;
    if (request.revision !== this.#keptRevision) {
      this.#kept.clear();
      this.#keptRevision = request.revision;
    }
    this.#kept.set(request.time.toString(), { blob, quality: request.quality, best: request.best });
    this.keptTimes.value = this.#kept.names().map(Number);
  }

  /** Whether a kept picture will do for a request. */
  #isKept(request: FrameRequest): boolean {
    const kept = request.revision === this.#keptRevision ? this.#kept.get(request.time.toString()) : undefined;
    if (!kept) return false;
    return request.best
      ? kept.best && kept.quality.width === request.quality.width && kept.quality.motion === request.quality.motion
      : kept.quality.width >= 0.65 * request.quality.width;
  }

  #show(picture: Displayed): void {
    this.displayed.peek()?.bitmap.close();
    this.displayed.value = picture;
  }
}
