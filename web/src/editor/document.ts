/** One shot as it is at the service: its focus points, lens and curve, and the edits that change them. */

import { batch, computed, signal, type ReadonlySignal } from "@preact/signals";
import type { Change, Trial } from "../model/command";
import { sampleAt, type Curve } from "../model/curve";
import { NO_HISTORY, redoLabel, undoLabel, type Labels } from "../model/history";
import type { FocusPoint, FocusSettings, Readout, Shot } from "../model/shot";
import { sameTime } from "../model/time";
import { isAbort } from "../net/errors";
import { NewestWins } from "../net/newest";
import { Recent } from "../net/recent";
import type { Service, View } from "../net/service";

const NOTHING_TRIED: readonly Trial[] = [];

type Fail = (error: unknown) => void;

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
  readonly #readout = signal<{ readonly revision: number; readonly time: number; readonly value: Readout } | null>(
    null,
  );
  readonly #triedReadout = signal<{ readonly time: number; readonly value: Readout } | null>(null);
  readonly #settings = signal<{ readonly revision: number; readonly value: FocusSettings } | null>(null);
  readonly #curveRevision = signal(-1);
  readonly #labels = signal<Labels>(new Map());
  readonly #time: ReadonlySignal<number>;

  readonly #service: Service;
  readonly #fail: Fail;
  readonly #pointsAt = new Recent<Promise<FocusPoint[]>>(512);
  readonly #followPoints: NewestWins<number, FocusPoint[]>;
  readonly #followReadout: NewestWins<{ time: number; revision: number }, Readout>;
  readonly #followSettings: NewestWins<{ time: number; revision: number }, FocusSettings>;
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
      onResult: (value, request) => {
        batch(() => {
          this.#readout.value = { ...request, value };
          if (request.revision === this.revision.value && this.tried.value.length === 0)
            this.#triedReadout.value = null;
        });
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
    this.#followReadout.want({ request: { time, revision } });
    this.#followSettings.want({ request: { time, revision } });
  }

  /** Fetches the curve of a revision. */
  refreshCurve(revision: number): void {
    if (!this.hasLens) return;
    this.#followCurve.want({ request: revision });
  }

  /** The focus points at a time, asked for once in each revision. */
  pointsAt(time: number): Promise<FocusPoint[]> {
    if (!this.hasLens) return Promise.resolve([]);
    const name = `${this.revision.value}@${time}`;
    const known = this.#pointsAt.get(name);
    if (known) return known;
    const asked = this.#service.focusPoints(this.view, time);
    this.#pointsAt.set(name, asked);
    asked.catch(() => {
      this.#pointsAt.delete(name);
    });
    return asked;
  }

  readonly undoLabel = computed(() => undoLabel(this.history.value, this.#labels.value));
  readonly redoLabel = computed(() => redoLabel(this.history.value, this.#labels.value));

  /**
   * Makes an edit, which is one step of undo. Resolves to whether it was made.
   *
   * @param tried is shown until then, and is what comes of it.
   */
  edit(label: string, change: Change, tried?: readonly Trial[]): Promise<boolean> {
    if (change.length === 0) {
      if (tried) this.stopTrying();
      return Promise.resolve(true);
    }
    const time = this.#time.peek();
    return this.#inTurn(async () => {
      await this.#make(change, time, freshGesture());
      await this.#name(label);
    }, tried);
  }

  /** Takes back the last edit; nothing where somebody edited since it was shown what that is. */
  undo(): Promise<boolean> {
    if (this.pending.peek() === 0 && this.history.peek().before === null) return Promise.resolve(false);
    return this.#inTurn(async () => {
      const { before, revision } = this.history.value;
      if (before !== null) this.history.value = await this.#service.undo(this.shot.id, revision);
    });
  }

  redo(): Promise<boolean> {
    if (this.pending.peek() === 0 && this.history.peek().after === null) return Promise.resolve(false);
    return this.#inTurn(async () => {
      const { after, revision } = this.history.value;
      if (after !== null) this.history.value = await this.#service.redo(this.shot.id, revision);
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
   * @param make the change to a value.
   */
  drag<Value>(label: string, make: (value: Value) => Change): Drag<Value> {
    return {
      move: (value) => {
        this.try(make(value));
      },
      commit: (value) => {
        const change = make(value);
        this.tried.value = change;
        void this.edit(label, change, change);
        this.dragging.value = false;
      },
      cancel: () => {
        this.stopTrying();
      },
    };
  }

  /** Has the picture show what is not saved, in place of what it tried before. */
  try(tried: readonly Trial[]): void {
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
  hearReadout(readout: Readout, tried: readonly Trial[]): void {
    if (tried === this.tried.value || this.dragging.value)
      this.#triedReadout.value = { time: this.#time.peek(), value: readout };
  }

  /** Asks again for everything, as after an edit. */
  refresh(): void {
    this.#service.forget(this.shot.id);
    this.#pointsAt.clear();
    this.revision.value += 1;
  }

  /** Lets go of everything that is under way. */
  close(): void {
    for (const follower of [this.#followPoints, this.#followReadout, this.#followSettings, this.#followCurve])
      follower.clear();
  }

  /**
   * Does something after all that was begun before, and then asks again for everything. Resolves to whether it was done.
   *
   * @param tried is not shown any more then.
   */
  #inTurn(task: () => Promise<void>, tried?: readonly Trial[]): Promise<boolean> {
    this.pending.value += 1;
    const done = this.#queue.then(async () => {
      try {
        await task();
        return true;
      } catch (error) {
        if (!isAbort(error)) this.#fail(error);
        this.#triedReadout.value = null;
        this.history.value = await this.#service.history(this.shot.id).catch(() => this.history.peek());
        return false;
      } finally {
        batch(() => {
          if (tried && this.tried.value === tried) this.tried.value = NOTHING_TRIED;
          this.refresh();
          this.pending.value -= 1;
        });
      }
    });
    this.#queue = done;
    return done;
  }

  /** Sends commands; if one of several is refused, those before it are taken back. */
  async #make(change: Change, time: number, gesture: string): Promise<void> {
    const before = change.length > 1 ? (await this.#service.history(this.shot.id)).revision : null;
    let made = 0;
    try {
      for (const command of change) {
        await this.#service.perform(this.view, command, time, gesture);
        made += 1;
      }
    } catch (error) {
      if (before !== null && made > 0) await this.#takeBack(before, gesture).catch(() => undefined);
      throw error;
    }
  }

  /** Goes back to a revision, unless somebody else edited since. Within the gesture that leaves no trace in the history. */
  async #takeBack(revision: string, gesture: string): Promise<void> {
    const now = await this.#service.history(this.shot.id);
    if (now.before === revision) await this.#service.restore(this.shot.id, revision, now.revision, gesture);
    this.history.value = await this.#service.history(this.shot.id);
  }

  /** Gives the edit that was made last the name that a person knows it by. */
  async #name(label: string): Promise<void> {
    const history = await this.#service.history(this.shot.id);
    if (history.revision !== this.history.value.revision)
      this.#labels.value = new Map(this.#labels.value).set(history.revision, label);
    this.history.value = history;
  }
}

/** Names one edit among those of all who edit the shot. */
function freshGesture(): string {
  return Array.from(crypto.getRandomValues(new Uint32Array(4)), (word) => word.toString(36)).join("-");
}
