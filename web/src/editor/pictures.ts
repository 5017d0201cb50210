/**
 * Keeps the picture on screen up with the time, the edits and the unsaved changes: a quick preview first, then better pictures up
 * to the exact one. They come live; without that connection each is a request of its own.
 */

import { computed, signal } from "@preact/signals";
import type { Changes } from "../model/changes";
import type { FocusMap } from "../model/focus_map";
import { draftQuality, type Quality } from "../model/quality";
import type { FocusPoint } from "../model/shot";
import { sameTime } from "../model/time";
import { ServiceError } from "../net/errors";
import { decodeFocusMap } from "../net/focus_map";
import type { FocusMaps, LiveLink, LiveListener, LivePicture, PictureRequest } from "../net/live_link";
import { NewestWins } from "../net/newest";
import { Recent } from "../net/recent";
import type { Service } from "../net/service";
import type { ShotDocument } from "./document";
import type { Fail } from "./fail";
import type { FrameCache } from "./frame_cache";

/** Pictures kept for playing again. */
const MOST_KEPT = 400;
/** Focus maps kept with them, which are many times larger. */
const MOST_KEPT_MAPS = 40;
/** Share of the width at rest from which a kept picture is good enough while things move. */
const GOOD_WIDTH = 0.45;
/** Rest before a whole picture is requested where pictures are not live, ms. */
const SETTLE_MS = 400;

const NO_CACHE: Pick<FrameCache, "find"> = { find: () => null };

/** In place of live pictures that may not be drawn. */
const NO_LINK: LiveLink = {
  free: true,
  request: () => undefined,
  cancel: () => undefined,
  close: () => undefined,
};

/** A picture on screen, with the points where they were at its time. */
export interface Displayed extends Omit<LivePicture, "blob" | "focusMap"> {
  readonly bitmap: ImageBitmap;
  readonly time: number;
  readonly revision: number;
  /** As requested; the picture may have less. */
  readonly quality: Quality;
  readonly unsaved: Changes;
  readonly points: readonly FocusPoint[];
  /** How sharp each pixel is; null where that was not asked for. */
  readonly focusMap: FocusMap | null;
}

/** A request for a picture of a revision of the document. */
export interface RevisionRequest extends PictureRequest {
  readonly revision: number;
}

/** A request with its number; later requests have greater ones. */
interface NumberedRequest extends RevisionRequest {
  readonly number: number;
}

interface Kept {
  readonly picture: LivePicture;
  readonly quality: Quality;
}

export class Pictures {
  readonly displayed = signal<Displayed | null>(null);
  /** Whether a better picture follows. */
  readonly busy = signal(false);
  /** Times whose picture is kept and can be played without the service. */
  readonly keptTimes = computed<readonly number[]>(() => {
    const { revision, times } = this.#keptTimes.value;
    return revision === this.#document.revision.value ? times : [];
  });

  /** Reason why no pictures may be drawn; null where they may. */
  readonly refusal: string | null;

  readonly #document: ShotDocument;
  readonly #cache: Pick<FrameCache, "find">;
  readonly #link: LiveLink;
  readonly #fetcher: NewestWins<NumberedRequest, LivePicture>;
  readonly #kept = new Recent<Kept>(MOST_KEPT);
  readonly #keptMaps = new Recent<ArrayBuffer>(MOST_KEPT_MAPS);
  /** The focus map that came last, and the number of its request. */
  #map: { readonly number: number; readonly read: Promise<FocusMap> } | null = null;
  #isLive = true;
  #keptRevision = -1;
  readonly #keptTimes = signal<{ readonly revision: number; readonly times: readonly number[] }>({
    revision: -1,
    times: [],
  });
  #current: NumberedRequest | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;
  /** Number of the newest request. */
  #newest = 0;
  /** Number of the newest request with an answer. */
  #answered = 0;
  #serial = 0;
  #shownSerial = 0;

  /** @param cache frames that are shown while things move. */
  constructor(
    service: Service,
    document: ShotDocument,
    fail: Fail,
    refusal: string | null = null,
    cache: Pick<FrameCache, "find"> = NO_CACHE,
  ) {
    this.#document = document;
    this.#cache = cache;
    this.refusal = refusal;
    const onError = (error: unknown): void => {
      this.busy.value = false;
      // A preview may be of keys that an edit under way has yet to make.
      const isEditing = document.pending.peek() > 0 || document.dragging.peek();
      if (isEditing && error instanceof ServiceError && error.status === 404) return;
      fail(error, () => {
        document.refresh();
      });
    };
    const listener: LiveListener = {
      onPicture: (picture, request) => this.#take(picture, request as NumberedRequest),
      onReadout: (readout, request) => {
        document.showReadout(readout, request.unsaved);
      },
      onError,
      onOpen: (isOpen) => {
        const was = this.#isLive;
        this.#isLive = isOpen;
        if (isOpen) this.#fetcher.clear();
        if (was !== isOpen && this.#current) this.#send(this.#current);
      },
    };
    this.#link = refusal === null ? service.live(document.view, listener) : NO_LINK;
    this.#fetcher = new NewestWins({
      load: async (request, signal) => {
        const quality = request.moving ? draftQuality(request.quality) : request.quality;
        const began = performance.now();
        const hasMap = request.focusMaps === "all" || (request.focusMaps === "final" && !request.moving);
        const [blob, map] = await Promise.all([
          service.frame(document.view, request.time, quality, signal),
          hasMap ? service.focusMap(document.view, request.time, quality, signal) : null,
        ]);
        const { width, height, rays } = quality;
        const [stage, share] = request.moving ? (["preview", 0] as const) : (["final", 1] as const);
        const tookMs = performance.now() - began;
        return { blob, stage, width, height, rays, share, tookMs, focusMap: map?.data ?? null };
      },
      onResult: (picture, request) => void this.#take(picture, request),
      onError,
    });
  }

  /** Whether the picture of a time is there, or would be made soon: else playing drops the frame. */
  isFreeFor(time: number): boolean {
    if (this.#cache.find(time)) return true;
    return this.#isLive ? this.#link.free : this.#fetcher.free;
  }

  /** Requests a picture in place of the one before. */
  request(picture: RevisionRequest): void {
    if (this.refusal !== null) return;
    if (this.#current && isSame(this.#current, picture) && (picture.moving || !this.#current.moving)) return;
    const request = { ...picture, number: (this.#newest += 1) };
    this.#current = request;
    const cached = request.moving && request.unsaved.length === 0 ? this.#cache.find(request.time) : null;
    if (cached) {
      this.#sendNothing();
      void this.#show(cached, request, this.#document.pointsByTime.known(request.time) ?? []);
      return;
    }
    const kept = this.#keptFor(request);
    if (kept) void this.#take(kept.picture, { ...request, quality: kept.quality });
    const isWhole = kept !== null && (request.moving || (kept.picture.stage === "final" && hasMap(kept, request)));
    if (isWhole) {
      this.#sendNothing();
      return;
    }
    this.#send(request);
  }

  /** Cancels the pictures under way, which belong to the request before. */
  #sendNothing(): void {
    this.busy.value = false;
    clearTimeout(this.#timer);
    this.#link.cancel();
    this.#fetcher.clear();
  }

  close(): void {
    clearTimeout(this.#timer);
    this.#current = null;
    this.#link.close();
    this.#fetcher.clear();
    this.displayed.value?.bitmap.close();
    this.displayed.value = null;
  }

  #send(request: NumberedRequest): void {
    clearTimeout(this.#timer);
    this.busy.value = !request.moving;
    if (this.#isLive) {
      this.#link.request(request);
      return;
    }
    // A single picture cannot have unsaved changes.
    if (request.unsaved.length > 0) return;
    this.#fetcher.load({ ...request, moving: true });
    if (request.moving) return;
    this.#timer = setTimeout(() => {
      this.#fetcher.load(request, { disposable: true });
    }, SETTLE_MS);
  }

  /** Takes a picture that was made. Resolves when it is on screen. */
  #take(picture: LivePicture, request: NumberedRequest): Promise<void> {
    this.#keep(picture, request);
    return this.#show(picture, request, this.#document.pointsAt(request.time));
  }

  /** Shows a picture, unless one of a later request or a better one is shown. Resolves when it is on screen. */
  async #show(
    picture: LivePicture,
    request: NumberedRequest,
    pointsThen: readonly FocusPoint[] | Promise<readonly FocusPoint[]>,
  ): Promise<void> {
    if (request.number < this.#answered) return;
    this.#answered = request.number;
    const serial = (this.#serial += 1);
    const { blob, focusMap: encoded, ...facts } = picture;
    const { number, time, revision, quality, unsaved } = request;
    if (encoded) this.#map = { number, read: decodeFocusMap(encoded) };
    // The map is that of the request: it goes on while its pictures get better.
    const map = this.#map?.number === number ? this.#map.read : null;
    const [bitmap, points, focusMap] = await Promise.all([createImageBitmap(blob), pointsThen, map]);
    if (serial < this.#shownSerial || this.#current === null) {
      bitmap.close();
      return;
    }
    this.#shownSerial = serial;
    this.displayed.peek()?.bitmap.close();
    this.displayed.value = { ...facts, bitmap, time, revision, quality, unsaved, points, focusMap };
    if (facts.stage === "final" && isSame(this.#current, request)) this.busy.value = false;
  }

  #keep(picture: LivePicture, { time, revision, quality, unsaved }: RevisionRequest): void {
    if (unsaved.length > 0 || revision !== this.#document.revision.value) return;
    if (revision !== this.#keptRevision) {
      this.#kept.clear();
      this.#keptMaps.clear();
      this.#keptRevision = revision;
    }
    const { focusMap, ...rest } = picture;
    if (focusMap) this.#keptMaps.set(time.toString(), focusMap);
    const before = this.#kept.get(time.toString());
    if (before && picture.stage !== "final" && before.picture.width > picture.width) return;
    this.#kept.set(time.toString(), { picture: { ...rest, focusMap: null }, quality });
    this.#keptTimes.value = { revision, times: this.#kept.names().map(Number) };
  }

  /** A kept picture that is good enough for a request. */
  #keptFor({ time, revision, quality, unsaved, moving, focusMaps }: RevisionRequest): Kept | null {
    const found = revision === this.#keptRevision && unsaved.length === 0 ? this.#kept.get(time.toString()) : undefined;
    if (!found) return null;
    const focusMap = this.#keptMaps.get(time.toString()) ?? null;
    if (moving && focusMaps === "all" && focusMap === null) return null;
    const kept = { ...found, picture: { ...found.picture, focusMap } };
    const isWhole =
      kept.picture.stage === "final" && kept.quality.width === quality.width && kept.quality.motion === quality.motion;
    return isWhole || (moving && kept.picture.width >= GOOD_WIDTH * quality.width) ? kept : null;
  }
}

/** Whether a kept picture has the focus map that a request asks for. */
function hasMap({ picture }: Kept, { focusMaps }: RevisionRequest): boolean {
  return focusMaps === "none" || picture.focusMap !== null;
}

const RANKS: Readonly<Record<FocusMaps, number>> = { none: 0, final: 1, all: 2 };

/** Whether a request gives the picture that another one is for, at any quality of its rays. */
function isSame(one: RevisionRequest, other: RevisionRequest): boolean {
  return (
    RANKS[one.focusMaps] >= RANKS[other.focusMaps] &&
    one.revision === other.revision &&
    sameTime(one.time, other.time) &&
    (one.unsaved === other.unsaved || (one.unsaved.length === 0 && other.unsaved.length === 0)) &&
    one.quality.width === other.quality.width &&
    one.quality.height === other.quality.height &&
    one.quality.motion === other.quality.motion
  );
}
