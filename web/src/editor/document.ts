/** One shot as it is at the service: its focus points, lens and curve, and the edits that change them. */

import { batch, computed, signal, type ReadonlySignal } from "@preact/signals";
import type { Changes } from "../model/changes";
import { sampleAt, type Curve } from "../model/curve";
import { NO_HISTORY, redoLabel, undoLabel } from "../model/history";
import type { FocusPoint, FocusSettings, Readout, Shot } from "../model/shot";
import { frameCount, sameTime } from "../model/time";
import { isAbort } from "../net/errors";
import { NewestWins } from "../net/newest";
import { Recent } from "../net/recent";
import type { Edited, Service } from "../net/service";
import type { View } from "../net/view";

const NOTHING_TRIED: Changes = [];
/** Frames of a shot whose focus curve comes with the answer to an edit; that of a longer one is read after it. */
const MOST_CURVE_FRAMES = 500;

type Fail = (error: unknown) => void;

/** When something was read. */
interface At {
  readonly time: number;
  readonly revision: number;
}

/** A change that a person is still dragging: tried in the picture as it goes, and one edit in the end. */
export interface Drag<Value> {
  move(value: Value): void;
  commit(value: Value): void;
  /** Leaves what was there before. */
  cancel(): void;
}

export class ShotDocument {
  readonly shot: Shot;
  readonly view: View;
  /** Goes up with every change; what was fetched for a lower one is stale. */
  readonly revision = signal(0);
  readonly points = signal<readonly FocusPoint[]>([]);
  readonly curve = signal<Curve>([]);
  /** What can be undone, here and by whoever else edits the shot. */
  readonly history = signal(NO_HISTORY);
  /** A hand is trying something. */
  readonly dragging = signal(false);
  /** What the picture shows beyond what is saved: what a hand is trying, or has just let go of. */
  readonly tried = signal(NOTHING_TRIED);
  /** Edits that are on their way. */
  readonly pending = signal(0);
  readonly #readout = signal<(At & { readonly value: Readout }) | null>(null);
  readonly #triedReadout = signal<{ readonly time: number; readonly value: Readout } | null>(null);
  readonly #settings = signal<{ readonly revision: number; readonly value: FocusSettings } | null>(null);
  readonly #curveRevision = signal(-1);
  readonly #time: ReadonlySignal<number>;

  readonly #service: Service;
  readonly #fail: Fail;
  /** The shot as the last edit left it. */
  #edited: (Edited & At) | null = null;
  readonly #pointsAt = new Recent<Promise<readonly FocusPoint[]>>(512);
  readonly #followPoints: NewestWins<number, readonly FocusPoint[]>;
  readonly #followReadout: NewestWins<At, Readout>;
  readonly #followSettings: NewestWins<At, FocusSettings>;
  readonly #followCurve: NewestWins<number, Curve>;
  #queue: Promise<unknown> = Promise.resolve();

  constructor(service: Service, shot: Shot, camera: string | null, time: ReadonlySignal<number>, fail: Fail) {
    this.#service = service;
    this.shot = shot;
    this.view = { shot: shot.id, camera };
    this.#time = time;
    this.#fail = fail;
    this.#followPoints = new NewestWins({
      load: (at) => this.pointsAt(at),
      onResult: (points) => (this.points.value = points),
      onError: fail,
      mostInFlight: 1,
    });
    this.#followReadout = new NewestWins({
      load: ({ time: at }, signal) => service.readout(this.view, at, signal),
      onResult: (value, at) => {
        this.#takeReadout(value, at);
      },
      onError: fail,
      mostInFlight: 1,
    });
    this.#followSettings = new NewestWins({
      load: ({ time: at }, signal) => service.focusSettings(this.view, at, signal),
      onResult: (value, { revision }) => (this.#settings.value = { revision, value }),
      onError: fail,
      mostInFlight: 1,
    });
    this.#followCurve = new NewestWins({
      load: (_, signal) => service.curve(this.view, signal),
      onResult: (curve, revision) => {
        this.curve.value = curve;
        this.#curveRevision.value = revision;
      },
      onError: fail,
      mostInFlight: 1,
    });
  }

  /** A shot without a camera is framed by one that has no prim, so there is no lens to set and nothing to key. */
  get hasLens(): boolean {
    return this.view.camera !== null;
  }

  /** The lens now: as it is tried, else from the curve where it is up to date, else what the service last said. */
  readonly readout = computed<Readout | null>(() => {
    const told = this.#readout.value;
    const tried = this.#triedReadout.value;
    if (tried && sameTime(tried.time, this.#time.value)) return tried.value;
    if (told?.revision === this.revision.value && sameTime(told.time, this.#time.value)) return told.value;
    const sample =
      this.#curveRevision.value === this.revision.value ? sampleAt(this.curve.value, this.#time.value) : null;
    return told && sample ? { ...told.value, ...sample } : (told?.value ?? null);
  });

  /** How the focus is found, as the service last said. */
  readonly focusSettings = computed(() => this.#settings.value?.value ?? null);

  /** Whether `readout` and `focusSettings` are what the service has now. */
  readonly fresh = computed(
    () =>
      this.pending.value === 0 &&
      this.#readout.value?.revision === this.revision.value &&
      this.#settings.value?.revision === this.revision.value,
  );

  /** Fetches what belongs to a time of a revision; while something moves only what is needed for that. */
  follow(time: number, moving: boolean, revision: number): void {
    if (!this.hasLens) return;
    this.#followPoints.want({ request: time });
    if (moving) return;
    const at = { time, revision };
    const edited = this.edited(at);
    if (edited?.readout) this.#takeReadout(edited.readout, at);
    else this.#followReadout.want({ request: at });
    if (edited?.focusSettings) this.#settings.value = { revision, value: edited.focusSettings };
    else this.#followSettings.want({ request: at });
  }

  /** Fetches the curve of a revision. */
  refreshCurve(revision: number): void {
    if (!this.hasLens) return;
    if (this.#edited?.revision === revision && this.#edited.curve) {
      this.curve.value = this.#edited.curve;
      this.#curveRevision.value = revision;
    } else this.#followCurve.want({ request: revision });
  }

  /** The answer to the edit that made a revision, where it is of that time: nothing has to be read again. */
  edited({ time, revision }: At): Edited | null {
    return this.#edited?.revision === revision && sameTime(this.#edited.time, time) ? this.#edited : null;
  }

  /** The focus points at a time, asked for once in each revision. */
  pointsAt(time: number): Promise<readonly FocusPoint[]> {
    if (!this.hasLens) return Promise.resolve([]);
    const name = nameOf({ time, revision: this.revision.value });
    const known = this.#pointsAt.get(name);
    if (known) return known;
    const asked = this.#service.focusPoints(this.view, time);
    this.#pointsAt.set(name, asked);
    asked.catch(() => {
      this.#pointsAt.delete(name);
    });
    return asked;
  }

  readonly undoLabel = computed(() => undoLabel(this.history.value));
  readonly redoLabel = computed(() => redoLabel(this.history.value));

  /**
   * Makes an edit: one request, all of it or nothing, one step of undo. Resolves to whether it was made.
   *
   * @param changes a promise where they have to be read first, as from a file.
   * @param tried is shown until then, and is what comes of it.
   */
  edit(label: string, changes: Changes | Promise<Changes>, tried?: Changes): Promise<boolean> {
    if (!(changes instanceof Promise) && changes.length === 0) {
      if (tried) this.stopTrying();
      return Promise.resolve(true);
    }
    const time = this.#time.peek();
    const withCurve = frameCount(this.shot.range) <= MOST_CURVE_FRAMES;
    return this.#inTurn(async () => {
      const edited = await this.#service.edit(this.view, { label, changes: await changes, time, withCurve });
      this.history.value = edited.history;
      return { ...edited, time };
    }, tried);
  }

  /** Takes back the last edit; nothing where somebody edited since it was shown what that is. */
  undo(): Promise<boolean> {
    if (this.pending.peek() === 0 && this.history.peek().before === null) return Promise.resolve(false);
    return this.#inTurn(async () => {
      const { before, revision } = this.history.value;
      if (before !== null) this.history.value = await this.#service.undo(this.shot.id, revision);
      return null;
    });
  }

  redo(): Promise<boolean> {
    if (this.pending.peek() === 0 && this.history.peek().after === null) return Promise.resolve(false);
    return this.#inTurn(async () => {
      const { after, revision } = this.history.value;
      if (after !== null) this.history.value = await this.#service.redo(this.shot.id, revision);
      return null;
    });
  }

  /** Looks whether somebody else edited the shot, and if so shows it as it is now. */
  async catchUp(): Promise<void> {
    const known = this.history.peek();
    try {
      const history = await this.#service.history(this.shot.id);
      const isEditing = this.pending.peek() > 0 || this.dragging.peek() || this.history.peek() !== known;
      if (isEditing || history.revision === known.revision) return;
      this.history.value = history;
      if (known !== NO_HISTORY) this.refresh();
    } catch (error) {
      this.#fail(error);
    }
  }

  /**
   * Starts a drag. Its values are tried in the picture; the last one is made an edit.
   *
   * @param make the changes to a value.
   */
  drag<Value>(label: string, make: (value: Value) => Changes): Drag<Value> {
    return {
      move: (value) => {
        this.try(make(value));
      },
      commit: (value) => {
        const changes = make(value);
        this.tried.value = changes;
        void this.edit(label, changes, changes);
        this.dragging.value = false;
      },
      cancel: () => {
        this.stopTrying();
      },
    };
  }

  /** Has the picture show what is not saved, in place of what it tried before. */
  try(tried: Changes): void {
    batch(() => {
      this.tried.value = tried;
      this.dragging.value = true;
    });
  }

  /** Shows again what is saved. */
  stopTrying(): void {
    batch(() => {
      this.tried.value = NOTHING_TRIED;
      this.#triedReadout.value = null;
      this.dragging.value = false;
    });
  }

  /** The lens in a picture in which something was tried. */
  hearReadout(readout: Readout, tried: Changes): void {
    if (tried === this.tried.value || this.dragging.value)
      this.#triedReadout.value = { time: this.#time.peek(), value: readout };
  }

  /**
   * Shows the shot as it is now.
   *
   * @param edited what the answer to an edit says of it; null reads everything again.
   */
  refresh(edited: (Edited & { readonly time: number }) | null = null): void {
    const revision = this.revision.value + 1;
    this.#service.forget(this.shot.id);
    this.#pointsAt.clear();
    this.#edited = edited && { ...edited, revision };
    if (edited?.points) this.#pointsAt.set(nameOf({ time: edited.time, revision }), Promise.resolve(edited.points));
    this.revision.value = revision;
  }

  /** Lets go of everything that is under way. */
  close(): void {
    for (const follower of [this.#followPoints, this.#followReadout, this.#followSettings, this.#followCurve])
      follower.clear();
  }

  #takeReadout(value: Readout, at: At): void {
    batch(() => {
      this.#readout.value = { ...at, value };
      if (at.revision === this.revision.value && this.tried.value.length === 0) this.#triedReadout.value = null;
    });
  }

  /**
   * Does something after all that was begun before, and then shows the shot as it is. Resolves to whether it was done.
   *
   * @param task resolves to the answer to an edit, or to null where everything is to be read again.
   * @param tried is not shown any more then.
   */
  #inTurn(task: () => Promise<(Edited & { readonly time: number }) | null>, tried?: Changes): Promise<boolean> {
    this.pending.value += 1;
    const done = this.#queue.then(async () => {
      let edited: (Edited & { readonly time: number }) | null = null;
      try {
        edited = await task();
        return true;
      } catch (error) {
        if (!isAbort(error)) this.#fail(error);
        this.#triedReadout.value = null;
        this.history.value = await this.#service.history(this.shot.id).catch(() => this.history.peek());
        return false;
      } finally {
        batch(() => {
          if (tried && this.tried.value === tried) this.tried.value = NOTHING_TRIED;
          this.refresh(edited);
          this.pending.value -= 1;
        });
      }
    });
    this.#queue = done;
    return done;
  }
}

/** Names what was read at a time of a revision. */
function nameOf({ time, revision }: At): string {
  return `${revision}@${time}`;
}
