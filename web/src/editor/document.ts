/** One shot as the service has it: its focus points, lens and curve, and the edits that change them. */

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

const NO_CHANGES: Changes = [];
/** Frames of a shot whose focus curve comes with the answer to an edit; that of a longer one is read after it. */
const MOST_CURVE_FRAMES = 500;

type Fail = (error: unknown) => void;

/** Time and revision of something read. */
interface At {
  readonly time: number;
  readonly revision: number;
}

/** A drag: its values are previewed in the picture, and the last one is an edit. */
export interface Drag<Value> {
  move(value: Value): void;
  commit(value: Value): void;
  /** Leaves the shot as it was. */
  cancel(): void;
}

export class ShotDocument {
  readonly shot: Shot;
  readonly view: View;
  /** Goes up with every edit; data of a lower one is stale. */
  readonly revision = signal(0);
  readonly points = signal<readonly FocusPoint[]>([]);
  readonly curve = signal<Curve>([]);
  /** The history of the shot, which other editors share. */
  readonly history = signal(NO_HISTORY);
  /** A drag is under way. */
  readonly dragging = signal(false);
  /** Changes that the picture shows and that are not saved: those of a drag, or of an edit that is under way. */
  readonly unsaved = signal(NO_CHANGES);
  /** Number of edits under way. */
  readonly pending = signal(0);
  readonly #readout = signal<(At & { readonly value: Readout }) | null>(null);
  readonly #previewReadout = signal<{ readonly time: number; readonly value: Readout } | null>(null);
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

  /** The lens now: of the unsaved changes, else of the present revision, else of the curve, else as last read. */
  readonly readout = computed<Readout | null>(() => {
    const saved = this.#readout.value;
    const unsaved = this.#previewReadout.value;
    if (unsaved && sameTime(unsaved.time, this.#time.value)) return unsaved.value;
    if (saved?.revision === this.revision.value && sameTime(saved.time, this.#time.value)) return saved.value;
    const sample =
      this.#curveRevision.value === this.revision.value ? sampleAt(this.curve.value, this.#time.value) : null;
    return saved && sample ? { ...saved.value, ...sample } : (saved?.value ?? null);
  });

  /** The focus settings as last read. */
  readonly focusSettings = computed(() => this.#settings.value?.value ?? null);

  /** Whether `readout` and `focusSettings` are of the present revision. */
  readonly fresh = computed(
    () =>
      this.pending.value === 0 &&
      this.#readout.value?.revision === this.revision.value &&
      this.#settings.value?.revision === this.revision.value,
  );

  /** Reads the state at a time of a revision; while something moves only the focus points. */
  follow(time: number, moving: boolean, revision: number): void {
    if (!this.hasLens) return;
    this.#followPoints.load(time);
    if (moving) return;
    const at = { time, revision };
    const edited = this.edited(at);
    if (edited?.readout) {
      this.#followReadout.clear(); // a reading under way is of an earlier revision
      this.#takeReadout(edited.readout, at);
    } else this.#followReadout.load(at);
    if (edited?.focusSettings) {
      this.#followSettings.clear();
      this.#settings.value = { revision, value: edited.focusSettings };
    } else this.#followSettings.load(at);
  }

  /** Reads the curve of a revision. */
  refreshCurve(revision: number): void {
    if (!this.hasLens) return;
    if (this.#edited?.revision === revision && this.#edited.curve) {
      this.#followCurve.clear();
      this.curve.value = this.#edited.curve;
      this.#curveRevision.value = revision;
    } else this.#followCurve.load(revision);
  }

  /** The answer to the edit that led to a revision, if it is of that time; null otherwise. */
  edited({ time, revision }: At): Edited | null {
    return this.#edited?.revision === revision && sameTime(this.#edited.time, time) ? this.#edited : null;
  }

  /** The focus points at a time, read once in each revision. */
  pointsAt(time: number): Promise<readonly FocusPoint[]> {
    if (!this.hasLens) return Promise.resolve([]);
    const name = nameOf({ time, revision: this.revision.value });
    const known = this.#pointsAt.get(name);
    if (known) return known;
    const points = this.#service.focusPoints(this.view, time);
    this.#pointsAt.set(name, points);
    points.catch(() => {
      this.#pointsAt.delete(name);
    });
    return points;
  }

  readonly undoLabel = computed(() => undoLabel(this.history.value));
  readonly redoLabel = computed(() => redoLabel(this.history.value));

  /**
   * Makes an edit: one request, all of it or nothing, one step of undo. Resolves to whether it was made.
   *
   * @param changes of the edit; a promise where a file has to be read first.
   * @param unsaved changes that the picture shows until the edit is made.
   */
  edit(label: string, changes: Changes | Promise<Changes>, unsaved?: Changes): Promise<boolean> {
    if (!(changes instanceof Promise) && changes.length === 0) {
      if (unsaved) this.endPreview();
      return Promise.resolve(true);
    }
    const time = this.#time.peek();
    const withCurve = frameCount(this.shot.range) <= MOST_CURVE_FRAMES;
    return this.#inTurn(async () => {
      const edited = await this.#service.edit(this.view, { label, changes: await changes, time, withCurve });
      this.history.value = edited.history;
      return { ...edited, time };
    }, unsaved);
  }

  /** Undoes the last edit, unless another editor has edited since the history was read. */
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

  /** Reads the history, and the shot again if another editor has changed it. */
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
   * Starts a drag. Its values are previewed in the picture; the last one is an edit.
   *
   * @param make the changes to a value.
   */
  drag<Value>(label: string, make: (value: Value) => Changes): Drag<Value> {
    return {
      move: (value) => {
        this.preview(make(value));
      },
      commit: (value) => {
        const changes = make(value);
        this.unsaved.value = changes;
        void this.edit(label, changes, changes);
        this.dragging.value = false;
      },
      cancel: () => {
        this.endPreview();
      },
    };
  }

  /** Shows unsaved changes in the picture, in place of those before. */
  preview(unsaved: Changes): void {
    batch(() => {
      this.unsaved.value = unsaved;
      this.dragging.value = true;
    });
  }

  /** Shows the saved state again. */
  endPreview(): void {
    batch(() => {
      this.unsaved.value = NO_CHANGES;
      this.#previewReadout.value = null;
      this.dragging.value = false;
    });
  }

  /** Takes the readout of the lens in a picture with unsaved changes. */
  showReadout(readout: Readout, unsaved: Changes): void {
    if (unsaved === this.unsaved.value || this.dragging.value)
      this.#previewReadout.value = { time: this.#time.peek(), value: readout };
  }

  /**
   * Shows the shot as it is now.
   *
   * @param edited answer to an edit, which is shown as it is; null reads everything again.
   */
  refresh(edited: (Edited & { readonly time: number }) | null = null): void {
    const revision = this.revision.value + 1;
    this.#service.forget(this.shot.id);
    this.#pointsAt.clear();
    this.#edited = edited && { ...edited, revision };
    if (edited?.points) this.#pointsAt.set(nameOf({ time: edited.time, revision }), Promise.resolve(edited.points));
    this.revision.value = revision;
  }

  /** Cancels all that is under way. */
  close(): void {
    for (const follower of [this.#followPoints, this.#followReadout, this.#followSettings, this.#followCurve])
      follower.clear();
  }

  #takeReadout(value: Readout, at: At): void {
    batch(() => {
      this.#readout.value = { ...at, value };
      if (at.revision === this.revision.value && this.unsaved.value.length === 0) this.#previewReadout.value = null;
    });
  }

  /**
   * Runs a task after those before it, and then shows the shot as it is. Resolves to whether the task succeeded.
   *
   * @param task resolves to the answer to an edit, or to null to read everything again.
   * @param unsaved changes whose preview ends with the task.
   */
  #inTurn(task: () => Promise<(Edited & { readonly time: number }) | null>, unsaved?: Changes): Promise<boolean> {
    this.pending.value += 1;
    const done = this.#queue.then(async () => {
      let edited: (Edited & { readonly time: number }) | null = null;
      try {
        edited = await task();
        return true;
      } catch (error) {
        if (!isAbort(error)) this.#fail(error);
        this.#previewReadout.value = null;
        this.history.value = await this.#service.history(this.shot.id).catch(() => this.history.peek());
        return false;
      } finally {
        batch(() => {
          if (unsaved && this.unsaved.value === unsaved) this.unsaved.value = NO_CHANGES;
          this.refresh(edited);
          this.pending.value -= 1;
        });
      }
    });
    this.#queue = done;
    return done;
  }
}

/** Key of what was read at a time of a revision. */
function nameOf({ time, revision }: At): string {
  return `${revision}@${time}`;
}
