/** One shot of the service, as the editor shows it: its focus points, lens and curve, and the edits that change them. */

import { batch, computed, signal, type ReadonlySignal } from "@preact/signals";
import { setFocusMode, type Changes } from "../model/changes";
import { mayChangeCameras } from "../model/choices";
import { sampleAt, type Curve } from "../model/curve";
import { NO_HISTORY, redoLabel, undoLabel, type EditHistory } from "../model/history";
import type { FocusPoint, FocusSettings, Readout, Shot } from "../model/shot";
import { frameCount, sameTime } from "../model/time";
import { isAbort } from "../net/errors";
import { frameDrawn } from "../net/frame_drawn";
import { NewestWins } from "../net/newest";
import type { EditResult, Service, Simplified } from "../net/service";
import type { View } from "../net/view";
import type { Drag } from "./drag";
import type { Fail } from "./fail";
import { noEditsHint } from "./hints";
import { PointsByTime } from "./points_by_time";
import { SolvedCurve } from "./solved_curve";

const NO_CHANGES: Changes = [];
/**
 * Shots of up to so many frames get their focus curve with the result of each edit; longer ones read it afterwards. An edit’s
 * label may have so many characters.
 */
const [MOST_CURVE_FRAMES, MOST_LABEL] = [500, 200];

/** Time and revision of something read. */
export interface At {
  readonly time: number;
  readonly revision: number;
}

type TimedResult = EditResult & { readonly time: number; readonly changes: Changes };

export class ShotDocument {
  readonly shot: Shot;
  readonly view: View;
  /** Counts the edits, undos and reloads seen here; data of an earlier revision is stale. */
  readonly revision = signal(0);
  readonly points = signal<readonly FocusPoint[]>([]);
  readonly solved: SolvedCurve;
  /** The history of the shot, which other editors share. */
  readonly history = signal(NO_HISTORY);
  readonly dragging = signal(false);
  /** Counts the undos and redos that were begun. */
  readonly walks = signal(0);
  /** What the last edit has made of the keys of a setting, where it simplified them. */
  readonly simplified = signal<Simplified | null>(null);
  /** Changes that the picture shows and that are not saved: those of a drag, or of an edit that is under way. */
  readonly unsaved = signal(NO_CHANGES);
  /** The view to open in place of this one, where cameras of the shot have come or gone; then nothing is read here any more. */
  readonly successor = signal<View | null>(null);
  /** Whether the lens as it stands is being read. */
  readonly reading = signal(false);
  /** Names of the edits under way, in their order. */
  readonly #labels = signal<readonly string[]>([]);
  /** Number of edits under way. */
  readonly pending = computed(() => this.#labels.value.length);
  /** The edit that is being saved; null for none. */
  readonly saving = computed(() => this.#labels.value[0] ?? null);
  readonly #readout = signal<(At & { readonly value: Readout }) | null>(null);
  readonly #previewReadout = signal<{ readonly time: number; readonly value: Readout } | null>(null);
  readonly #settings = signal<{ readonly revision: number; readonly value: FocusSettings } | null>(null);
  readonly #time: ReadonlySignal<number>;
  /** Reason why it may not be edited; null where it may. */
  readonly noEdits: ReadonlySignal<string | null>;
  readonly #service: Service;
  readonly #fail: Fail;
  /** Result of the last edit. */
  #lastEdit: (TimedResult & At) | null = null;
  /** The focus points at other times, in the present revision. */
  readonly pointsByTime: PointsByTime;
  readonly #followPoints: NewestWins<number, readonly FocusPoint[]>;
  readonly #followReadout: NewestWins<At, Readout>;
  readonly #followSettings: NewestWins<At, FocusSettings>;
  #queue: Promise<unknown> = Promise.resolve();

  constructor(
    service: Service,
    shot: Shot,
    camera: string | null,
    time: ReadonlySignal<number>,
    fail: Fail,
    noEdits: ReadonlySignal<string | null> = signal(null),
  ) {
    [this.#service, this.shot, this.#time, this.#fail, this.noEdits] = [service, shot, time, fail, noEdits];
    this.view = { shot: shot.id, camera };
    this.pointsByTime = new PointsByTime((at) => service.focusPoints(this.view, at));
    const onError = (error: unknown): void => {
      fail(error, () => {
        this.refresh();
      });
    };
    const follow = { onError, pause: frameDrawn, mostInFlight: 1 };
    this.#followPoints = new NewestWins({
      load: (at) => this.pointsAt(at),
      onResult: (points) => (this.points.value = points),
      ...follow,
    });
    this.#followReadout = new NewestWins({
      load: ({ time: at }, signal) => service.readout(this.view, at, signal),
      onResult: (value, at) => {
        this.#takeReadout(value, at);
      },
      onBusy: (isBusy) => (this.reading.value = isBusy),
      ...follow,
    });
    this.#followSettings = new NewestWins({
      load: ({ time: at }, signal) => service.focusSettings(this.view, at, signal),
      onResult: (value, { revision }) => (this.#settings.value = { revision, value }),
      ...follow,
    });
    this.solved = new SolvedCurve((abort) => service.curve(this.view, abort), onError);
  }

  /** A shot without a camera is framed by one that has no prim, so there is no lens to set and nothing to key. */
  get hasLens(): boolean {
    return this.view.camera !== null;
  }

  /** The focus curve as last solved. */
  get curve(): ReadonlySignal<Curve> {
    return this.solved.samples;
  }

  /** Readout of the lens now: with the unsaved changes, else of the present revision, else from the curve, else as last read. */
  readonly readout = computed<Readout | null>(() => {
    const [saved, preview] = [this.#readout.value, this.#previewReadout.value];
    if (preview && sameTime(preview.time, this.#time.value)) return preview.value;
    if (saved?.revision === this.revision.value && sameTime(saved.time, this.#time.value)) return saved.value;
    const sample =
      this.solved.revision.value === this.revision.value ? sampleAt(this.curve.value, this.#time.value) : null;
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

  /** Whether `points` are of the present time and revision. */
  get hasFreshPoints(): boolean {
    return this.pointsByTime.known(this.#time.peek()) === this.points.peek();
  }

  /** Reads focus points, readout and focus settings at a time; while the time or a drag is moving, the focus points alone. */
  follow(time: number, moving: boolean, revision: number): void {
    if (!this.hasLens) return;
    const points = this.pointsByTime.known(time);
    if (points) this.#followPoints.take(points, time);
    else this.#followPoints.load(time);
    if (moving) return;
    const at = { time, revision };
    const result = this.resultOf(at);
    if (result?.readout) this.#followReadout.take(result.readout, at);
    else this.#followReadout.load(at);
    if (result?.focusSettings) this.#followSettings.take(result.focusSettings, at);
    else this.#followSettings.load(at);
  }

  /** Reads the curve of a revision. */
  refreshCurve(revision: number): void {
    if (!this.hasLens) return;
    const known = this.#lastEdit?.revision === revision ? this.#lastEdit.curve : null;
    if (known) this.solved.take(known, revision);
    else this.solved.solve(revision);
  }

  /** Result of the edit that led to a revision, if it is for that time; null otherwise. */
  resultOf({ time, revision }: At): EditResult | null {
    return this.#lastEdit?.revision === revision && sameTime(this.#lastEdit.time, time) ? this.#lastEdit : null;
  }

  /** Changes of the edit that led to a revision; null where something else did. */
  readonly changesOf = (revision: number): Changes | null =>
    this.#lastEdit?.revision === revision ? this.#lastEdit.changes : null;

  /** The focus points at a time, read once in each revision. */
  pointsAt(time: number): Promise<readonly FocusPoint[]> {
    if (!this.hasLens) return Promise.resolve([]);
    return this.pointsByTime.at(time);
  }

  /** Lets the points decide the focus, in the way that they do already. */
  byPoints(): Changes {
    return this.readout.value?.focusMode === "manual" ? setFocusMode("points", "manual") : NO_CHANGES;
  }

  readonly undoLabel = computed(() => undoLabel(this.history.value));
  readonly redoLabel = computed(() => redoLabel(this.history.value));

  /**
   * Sends an edit: one request, applied whole or not at all, one step of undo. Resolves to whether it was applied.
   *
   * @param changes of the edit; a function where something has to be read for them, once the edits before it are made.
   * @param unsaved changes that the picture shows until the edit is applied.
   * @param gesture names a gesture: its edits, one after the other, are one step of undo.
   * @param onMade called when the service has made it, before anything is read of what came of it.
   */
  edit(
    label: string,
    changes: Changes | (() => Promise<Changes>),
    unsaved?: Changes,
    gesture?: string,
    onMade?: () => void,
  ): Promise<boolean> {
    if (this.#isRefused()) return Promise.resolve(false);
    if (typeof changes !== "function" && changes.length === 0) {
      if (unsaved) this.endPreview();
      return Promise.resolve(true);
    }
    const [time, withCurve] = [this.#time.peek(), frameCount(this.shot.range) <= MOST_CURVE_FRAMES];
    const task = async (): Promise<TimedResult | null> => {
      const known = typeof changes === "function" ? await changes() : changes;
      if (known.length === 0) return null;
      const edit = { label: label.slice(0, MOST_LABEL), gesture, changes: known, time, withCurve };
      const result = await this.#service.edit(this.view, edit);
      onMade?.();
      this.history.value = result.history;
      if (known.some(mayChangeCameras)) this.#takeHistory(await this.#service.history(this.shot.id));
      for (const created of result.cameras.slice(-1)) this.successor.value = { ...this.view, camera: created };
      this.simplified.value = result.simplified[0] ?? null;
      return { ...result, time, changes: known };
    };
    return this.#inTurn(label, task, () => void this.edit(label, changes, undefined, gesture, onMade), unsaved);
  }

  /** Undoes the last edit, unless another editor has edited since the history was read. */
  undo(): Promise<boolean> {
    return this.#walk("undo");
  }

  redo(): Promise<boolean> {
    return this.#walk("redo");
  }

  #walk(way: "undo" | "redo"): Promise<boolean> {
    const isEnd = (): boolean => this.history.peek()[way === "undo" ? "before" : "after"] === null;
    if (this.dragging.peek() || this.#isRefused() || (this.pending.peek() === 0 && isEnd()))
      return Promise.resolve(false);
    this.walks.value += 1;
    const step = async (): Promise<null> => {
      if (!isEnd()) this.#takeHistory(await this.#service[way](this.shot.id, this.history.peek().revision));
      this.simplified.value = null;
      return null;
    };
    return this.#inTurn(way, step, () => void this.#walk(way));
  }

  /** Resolves when all edits that were begun are made. */
  async idle(): Promise<void> {
    await this.#queue;
  }

  /** Whether nothing is edited here, so that the edits of others can be shown. */
  readonly resting = computed(() => this.pending.value === 0 && !this.dragging.value);

  /**
   * Reads the history, and the shot again if another editor has changed it. Resolves to false where an edit here came between,
   * after which there may still be something to read.
   *
   * @param told revision that the shot is said to have, whose state is then read beside its history; null for none.
   */
  async catchUp(told: string | null = null): Promise<boolean> {
    const known = this.history.peek();
    const reading = this.#service.history(this.shot.id);
    const isTold = told !== null && told !== known.revision && known !== NO_HISTORY && this.resting.peek();
    if (isTold) this.refresh();
    const history = await reading.catch((error: unknown) => {
      this.#fail(error, () => void this.catchUp());
      return known;
    });
    const isBetween = !this.resting.peek() || this.history.peek() !== known;
    if (isBetween || history.revision === known.revision) return !isBetween;
    this.#takeHistory(history);
    if (known !== NO_HISTORY && !(isTold && history.revision === told)) this.refresh();
    return true;
  }

  /**
   * Starts a drag. Its values are previewed in the picture; the last one is an edit.
   *
   * @param changesTo gives the changes that set a value.
   */
  drag<Value>(label: string, changesTo: (value: Value) => Changes): Drag<Value> {
    return {
      move: (value) => {
        this.preview(changesTo(value));
      },
      commit: (value) => {
        const changes = changesTo(value);
        this.unsaved.value = changes;
        void this.edit(label, changes, changes);
        this.dragging.value = false;
      },
      cancel: () => {
        this.endPreview();
      },
    };
  }

  /** Shows unsaved changes in the picture, in place of earlier ones. */
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

  /** Shows the readout that came with a picture of unsaved changes. */
  showReadout(readout: Readout, unsaved: Changes): void {
    if (unsaved === this.unsaved.value || this.dragging.value)
      this.#previewReadout.value = { time: this.#time.peek(), value: readout };
  }

  /**
   * Begins a new revision, whose data is then read.
   *
   * @param result of an edit, which saves reading its parts; null reads everything again.
   */
  refresh(result: TimedResult | null = null): void {
    if (this.successor.peek()) return;
    const revision = this.revision.value + 1;
    this.#service.forget(this.shot.id);
    this.#lastEdit = result && { ...result, revision };
    this.pointsByTime.forget(result?.points ? { time: result.time, points: result.points } : null);
    this.revision.value = revision;
  }

  /** Cancels all reading under way. */
  close(): void {
    for (const follower of [this.#followPoints, this.#followReadout, this.#followSettings]) follower.clear();
    this.solved.stop();
  }

  /** Tells the person why they may not edit, and returns whether they may not. */
  #isRefused(): boolean {
    const hint = noEditsHint(this.noEdits.peek());
    if (hint) this.#fail(hint, () => undefined);
    return hint !== null;
  }

  /** Takes a history that was read; where the shot has other cameras by now, the view is to be opened again. */
  #takeHistory(history: EditHistory): void {
    this.history.value = history;
    if (history.cameras && history.cameras.join() !== this.shot.cameraPaths.join()) this.successor.value = this.view;
  }

  #takeReadout(value: Readout, at: At): void {
    batch(() => {
      this.#readout.value = { ...at, value };
      if (at.revision === this.revision.value && this.unsaved.value.length === 0) this.#previewReadout.value = null;
    });
  }

  /**
   * Runs a task after those queued before it, and then refreshes. Resolves to whether the task succeeded.
   *
   * @param label names it.
   * @param task resolves to the result of an edit, or to null to read everything again.
   * @param again does it once more, where it fails.
   * @param unsaved changes whose preview ends with the task.
   */
  #inTurn(
    label: string,
    task: () => Promise<TimedResult | null>,
    again: () => void,
    unsaved?: Changes,
  ): Promise<boolean> {
    this.#labels.value = [...this.#labels.value, label];
    const done = this.#queue.then(async () => {
      let result: TimedResult | null = null;
      try {
        result = await task();
        return true;
      } catch (error) {
        if (!isAbort(error)) this.#fail(error, again);
        this.#previewReadout.value = null;
        this.#takeHistory(await this.#service.history(this.shot.id).catch(() => this.history.peek()));
        return false;
      } finally {
        batch(() => {
          if (unsaved && this.unsaved.value === unsaved) this.unsaved.value = NO_CHANGES;
          this.refresh(result);
          this.#labels.value = this.#labels.value.slice(1);
        });
      }
    });
    this.#queue = done;
    return done;
  }
}
