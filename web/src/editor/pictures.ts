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
import type { Other } from "../model/viewers";
import { ServiceError } from "../net/errors";
import { decodeFocusMap } from "../net/focus_map";
import type { LiveLink, LiveListener, LivePicture, PictureRequest } from "../net/live_link";
import { NewestWins } from "../net/newest";
import { Recent } from "../net/recent";
import type { Service } from "../net/service";
import type { ShotDocument } from "./document";
import type { Fail } from "./fail";
import type { FrameCache } from "./frame_cache";
import { KeptMaps } from "./kept_maps";

/** Pictures kept for playing again. */
const MOST_KEPT = 400;
/** Share of the width at rest from which a kept picture is good enough while things move. */
const GOOD_WIDTH = 0.45;
/** Rest before a whole picture is requested where pictures are not live, ms. */
const SETTLE_MS = 400;

const NO_CACHE: Pick<FrameCache, "find"> = { find: () => null };

/** In place of live pictures that may not be drawn. */
const NO_LINK: LiveLink = { free: true, request: ignore, look: ignore, cancel: ignore, close: ignore };

function ignore(): void {
  // Nobody is asked for anything.
}

/** A picture on screen, with the points where they were at its time. */
export interface Displayed extends Omit<LivePicture, "blob" | "focusMap"> {
  readonly bitmap: ImageBitmap;
  readonly time: number;
  readonly revision: number;
  /** As requested; the picture may have less. */
  readonly quality: Quality;
  readonly unsaved: Changes;
  readonly points: readonly FocusPoint[];
  /** Number of its request. */
  readonly number: number;
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
  /** Time of the frame of which a better picture follows; null where none does. */
  readonly drawing = signal<number | null>(null);
  /** Whether a better picture follows. */
  readonly busy = computed(() => this.drawing.value !== null);
  /** Whether the best picture was stopped on its way. */
  readonly stopped = signal(false);
  /** Times whose picture is kept and can be played without the service. */
  readonly keptTimes = computed<readonly number[]>(() => {
    const { revision, times } = this.#keptTimes.value;
    return revision === this.#document.revision.value ? times : [];
  });

  /** Who else looks at the shot; nobody where there are no live pictures. */
  readonly others = signal<readonly Other[]>([]);
  /** Reason why no pictures may be drawn; null where they may. */
  readonly refusal: string | null;

  readonly #document: ShotDocument;
  readonly #cache: Pick<FrameCache, "find">;
  readonly #fail: Fail;
  readonly #link: LiveLink;
  readonly #fetcher: NewestWins<NumberedRequest, LivePicture>;
  readonly #kept = new Recent<Kept>(MOST_KEPT);
  readonly #keptMaps = new KeptMaps();
  /** Number of the request whose focus map was asked for last. */
  #mapNumber = 0;
  /** Reads the focus map of the picture on screen, where none came with it. */
  readonly #mapReader: NewestWins<NumberedRequest, FocusMap>;
  /** The focus map that came last, and the number of its request. */
  #map: { readonly number: number; readonly read: Promise<FocusMap | null> } | null = null;
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
    [this.#document, this.#cache, this.#fail] = [document, cache, fail];
    this.refusal = refusal;
    const onError = (error: unknown): void => {
      this.drawing.value = null;
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
      onOthers: (others) => (this.others.value = others),
    };
    this.#link = refusal === null ? service.live(document.view, listener) : NO_LINK;
    this.#fetcher = new NewestWins({
      load: async (request, signal) => {
        const quality = request.moving ? draftQuality(request.quality) : request.quality;
        const began = performance.now();
        const blob = await service.frame(document.view, request.time, quality, signal);
        const { width, height, rays } = quality;
        const [stage, share] = request.moving ? (["preview", 0] as const) : (["final", 1] as const);
        return { blob, stage, width, height, rays, share, tookMs: performance.now() - began, focusMap: null };
      },
      onResult: (picture, request) => void this.#take(picture, request),
      onError,
    });
    this.#mapReader = this.#makeMapReader(service, onError);
  }

  /** Whether the picture of a time is there, or would be made soon: else playing drops the frame. */
  isFreeFor(time: number): boolean {
    if (this.#cachedFor(time, this.#current?.focusMaps ?? false)) return true;
    return this.#isLive ? this.#link.free : this.#fetcher.free;
  }

  /** Requests a picture in place of the one before. */
  request(picture: RevisionRequest): void {
    if (this.refusal !== null) return;
    if (this.#current && isSame(this.#current, picture) && (picture.moving || !this.#current.moving)) return;
    const request = { ...picture, number: (this.#newest += 1) };
    this.#current = request;
    const isSaved = request.unsaved.length === 0;
    const cached = request.moving && isSaved ? this.#cachedFor(request.time, request.focusMaps) : null;
    if (cached) {
      this.#sendNothing(request.time);
      void this.#show(cached, request, { readsPoints: false }); // many come in a second
      return;
    }
    const kept = this.#keptFor(request);
    if (kept) void this.#take(kept.picture, { ...request, quality: kept.quality });
    if (kept && (request.moving || kept.picture.stage === "final")) {
      this.#sendNothing(request.time);
      return;
    }
    this.#send(request);
  }

  /** Stops the pictures under way; what is on screen stays. */
  stop(): void {
    this.#sendNothing();
    this.stopped.value = true;
  }

  /** Draws the best picture after all, where it was stopped or has failed. */
  resume(): void {
    if (this.#current && !this.busy.peek()) this.#send(this.#current);
  }

  #makeMapReader(service: Service, onError: (error: unknown) => void): NewestWins<NumberedRequest, FocusMap> {
    const document = this.#document;
    return new NewestWins({
      load: async (request, signal) => {
        const { data } = await service.focusMap(document.view, request.time, request.quality, signal);
        if (request.revision === document.revision.peek()) this.#keptMaps.put(request.time, { data, isExact: true });
        return decodeFocusMap(data);
      },
      onResult: (focusMap, { number, revision }) => {
        const shown = this.displayed.peek();
        if (shown?.number === number && revision === document.revision.peek())
          this.displayed.value = { ...shown, focusMap };
      },
      onError,
      mostInFlight: 1,
    });
  }

  /** Reads the focus map of the exact picture on screen, unless it is there or under way. */
  readMap(): void {
    const [shown, current] = [this.displayed.peek(), this.#current];
    if (shown?.stage !== "final" || shown.focusMap || shown.unsaved.length > 0) return;
    if (current?.number !== shown.number || this.#mapNumber === current.number) return;
    this.#mapNumber = current.number;
    this.#mapReader.load(current);
  }

  /** A cached frame of a time, where it has the focus map that is wanted. */
  #cachedFor(time: number, focusMaps: boolean): LivePicture | null {
    const cached = this.#cache.find(time);
    return focusMaps && !cached?.focusMap ? null : cached;
  }

  /**
   * Cancels the pictures under way, which belong to the request before.
   *
   * @param shown time of the picture that needs no request; null where the picture on screen stays.
   */
  #sendNothing(shown: number | null = null): void {
    if (shown !== null) this.#link.look(shown);
    this.drawing.value = null;
    this.stopped.value = false;
    clearTimeout(this.#timer);
    this.#link.cancel();
    this.#fetcher.clear();
  }

  close(): void {
    clearTimeout(this.#timer);
    this.#current = null;
    this.#link.close();
    this.#fetcher.clear();
    this.#mapReader.clear();
    this.displayed.value?.bitmap.close();
    this.displayed.value = null;
  }

  #send(request: NumberedRequest): void {
    clearTimeout(this.#timer);
    this.drawing.value = request.moving ? null : request.time;
    this.stopped.value = false;
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
    return this.#show(picture, request);
  }

  /** Shows a picture, unless one of a later request or a better one is shown. Resolves when it is on screen. */
  async #show(picture: LivePicture, request: NumberedRequest, { readsPoints = true } = {}): Promise<void> {
    if (request.number < this.#answered) return;
    this.#answered = request.number;
    const serial = (this.#serial += 1);
    const { blob, focusMap: encoded, ...facts } = picture;
    const { number, time, revision, quality, unsaved } = request;
    if (encoded) this.#map = { number, read: this.#decode(encoded) };
    // The map is that of the request: it goes on while its pictures get better.
    const map = this.#map?.number === number ? this.#map.read : null;
    const [bitmap, focusMap] = await Promise.all([createImageBitmap(blob), map]);
    if (serial < this.#shownSerial || this.#current === null) {
      bitmap.close();
      return;
    }
    this.#shownSerial = serial;
    const [before, points] = [this.displayed.peek(), this.#document.pointsByTime.known(time)];
    before?.bitmap.close();
    this.displayed.value = {
      ...facts,
      ...{ number, bitmap, time, revision, quality, unsaved, focusMap },
      points: points ?? before?.points ?? [],
    };
    if (!points && readsPoints) void this.#addPoints(bitmap, time);
    if (request.focusMaps) this.readMap();
    if (facts.stage === "final" && isSame(this.#current, request)) this.drawing.value = null;
  }

  /** Reads the points of the picture on screen, which has those of the one before until then. */
  async #addPoints(bitmap: ImageBitmap, time: number): Promise<void> {
    try {
      const points = await this.#document.pointsAt(time);
      const shown = this.displayed.peek();
      if (shown?.bitmap === bitmap) this.displayed.value = { ...shown, points };
    } catch {
      // The document follows the time, too, and tells of what fails there.
    }
  }

  /** Decodes a map; a picture is shown without one that cannot be read. */
  async #decode(encoded: ArrayBuffer): Promise<FocusMap | null> {
    try {
      return await decodeFocusMap(encoded);
    } catch (error) {
      this.#fail(error, () => {
        this.#document.refresh();
      });
      return null;
    }
  }

  #keep(picture: LivePicture, { time, revision, quality, unsaved }: RevisionRequest): void {
    if (unsaved.length > 0 || revision !== this.#document.revision.value) return;
    if (revision !== this.#keptRevision) {
      this.#kept.clear();
      this.#keptMaps.clear();
      this.#keptRevision = revision;
    }
    const { focusMap, ...rest } = picture;
    if (focusMap) this.#keptMaps.put(time, { data: focusMap, isExact: picture.stage === "final" });
    const before = this.#kept.get(time.toString());
    if (before && picture.stage !== "final" && before.picture.width > picture.width) return;
    this.#kept.set(time.toString(), { picture: { ...rest, focusMap: null }, quality });
    this.#keptTimes.value = { revision, times: this.#kept.names().map(Number) };
  }

  /** A kept picture that is good enough for a request. */
  #keptFor({ time, revision, quality, unsaved, moving, focusMaps }: RevisionRequest): Kept | null {
    const found = revision === this.#keptRevision && unsaved.length === 0 ? this.#kept.get(time.toString()) : undefined;
    if (!found) return null;
    const map = focusMaps ? this.#keptMaps.get(time) : null;
    if (moving && focusMaps && map === null) return null;
    const focusMap = map && (moving || map.isExact) ? map.data : null;
    const kept = { ...found, picture: { ...found.picture, focusMap } };
    const isWhole =
      kept.picture.stage === "final" && kept.quality.width === quality.width && kept.quality.motion === quality.motion;
    return isWhole || (moving && kept.picture.width >= GOOD_WIDTH * quality.width) ? kept : null;
  }
}

/** Whether a request gives the picture that another one is for, at any quality of its rays. */
function isSame(one: RevisionRequest, other: RevisionRequest): boolean {
  return (
    (one.focusMaps || !other.focusMaps) &&
    one.revision === other.revision &&
    sameTime(one.time, other.time) &&
    (one.unsaved === other.unsaved || (one.unsaved.length === 0 && other.unsaved.length === 0)) &&
    one.quality.width === other.quality.width &&
    one.quality.height === other.quality.height &&
    one.quality.motion === other.quality.motion
  );
}
