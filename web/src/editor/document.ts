/** One shot as it is at the service: its focus points, lens and curve, and the edits that change them. */

import { computed, signal, type ReadonlySignal } from "@preact/signals";
import type { Change, Command, ShotEdit } from "../model/command";
import { sampleAt, type Curve } from "../model/curve";
import { emptyHistory, moved, pushed, redoable, undoable } from "../model/history";
import type { FocusPoint, Readout, Shot } from "../model/shot";
import { sameTime } from "../model/time";
import { isAbort } from "../net/errors";
import { NewestWins } from "../net/newest";
import { Recent } from "../net/recent";
import type { Service, View } from "../net/service";

type Fail = (error: unknown) => void;

/** A change that a person is still dragging: shown as it goes, and one edit in the end. */
export interface Drag<Value> {
  move(value: Value): void;
  commit(value: Value): void;
  /** Puts back what was there before. */
  cancel(): void;
}

export class ShotDocument {
  readonly shot: Shot;
  readonly view: View;
  /** Goes up with every change; what was fetched for a lower one is stale. */
  readonly revision = signal(0);
  readonly points = signal<readonly FocusPoint[]>([]);
  readonly curve = signal<Curve>([]);
  readonly history = signal(emptyHistory<Command>());
  readonly dragging = signal(false);
  /** Edits that are on their way. */
  readonly pending = signal(0);
  readonly #readout = signal<{ readonly revision: number; readonly time: number; readonly value: Readout } | null>(
    null,
  );
  readonly #curveRevision = signal(-1);
  readonly #time: ReadonlySignal<number>;

  readonly #service: Service;
  readonly #fail: Fail;
  readonly #pointsAt = new Recent<Promise<FocusPoint[]>>(512);
  readonly #followPoints: NewestWins<number, FocusPoint[]>;
  readonly #followReadout: NewestWins<{ time: number; revision: number }, Readout>;
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
      onResult: (value, request) => (this.#readout.value = { ...request, value }),
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

  /** The lens now: from the curve where it is up to date, else what the service last said. */
  readonly readout = computed<Readout | null>(() => {
    const told = this.#readout.value;
    if (told?.revision === this.revision.value && sameTime(told.time, this.#time.value)) return told.value;
    const sample =
      this.#curveRevision.value === this.revision.value ? sampleAt(this.curve.value, this.#time.value) : null;
    return told && sample ? { ...told.value, ...sample } : (told?.value ?? null);
  });

  /** Whether `readout` is what the service has now. */
  readonly fresh = computed(() => this.pending.value === 0 && this.#readout.value?.revision === this.revision.value);

  /** Fetches what belongs to a time of a revision; while something moves only what is needed for that. */
  follow(time: number, moving: boolean, revision: number): void {
    if (!this.hasLens) return;
    this.#followPoints.want({ request: time });
    if (!moving || this.dragging.value) this.#followReadout.want({ request: { time, revision } });
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

  /** Makes an edit that can be undone. Resolves to whether it was made. */
  async edit(label: string, change: Change): Promise<boolean> {
    if (change.redo.length === 0) return true;
    const made = await this.#send(change.redo, change.undo);
    if (made) this.history.value = pushed(this.history.value, { label, ...change });
    return made;
  }

  /** Makes an edit of more than can be told one by one: undone, all edits are what they were before it. */
  async editWhole(label: string, command: Command): Promise<boolean> {
    let revision = "";
    const remember = async (): Promise<void> => {
      revision = await this.#service.revision(this.shot.id);
    };
    const made = await this.#send([command], [], remember);
    const undo: Command = { do: "restoreEdits", revision };
    if (made) this.history.value = pushed(this.history.value, { label, redo: [command], undo: [undo] });
    return made;
  }

  async undo(): Promise<void> {
    const edit = undoable(this.history.value);
    if (edit) await this.#replay(-1, edit.undo, edit);
  }

  async redo(): Promise<void> {
    const edit = redoable(this.history.value);
    if (edit) await this.#replay(1, edit.redo, edit);
  }

  /**
   * Starts a drag. Values go to the service as fast as it takes them, the newest first, and are one edit in the end.
   *
   * @param from the value at the start.
   * @param make the change from what was there at the start to a value.
   */
  drag<Value>(label: string, from: NoInfer<Value>, make: (value: Value) => Change): Drag<Value> {
    let waiting: (() => Promise<unknown>) | null = null;
    let sending = false;
    const pump = async (next: () => Promise<unknown>): Promise<void> => {
      waiting = next;
      if (sending) return;
      sending = true;
      while (waiting) {
        const send: () => Promise<unknown> = waiting;
        waiting = null;
        await send();
      }
      sending = false;
    };
    const end = (last: () => Promise<unknown>): void => {
      void pump(async () => {
        this.dragging.value = false;
        await last();
      });
    };
    return {
      move: (value) => {
        this.dragging.value = true;
        void pump(() => this.#send(make(value).redo));
      },
      commit: (value) => {
        end(() => this.edit(label, make(value)));
      },
      cancel: () => {
        if (this.dragging.value) end(() => this.#send(make(from).undo));
      },
    };
  }

  /** Asks again for everything, as after an edit. */
  refresh(): void {
    this.#pointsAt.clear();
    this.revision.value += 1;
  }

  /** Lets go of everything that is under way. */
  close(): void {
    for (const follower of [this.#followPoints, this.#followReadout, this.#followCurve]) follower.clear();
  }

  async #replay(by: -1 | 1, commands: readonly Command[], edit: ShotEdit): Promise<void> {
    if (this.history.value.edits.includes(edit) && (await this.#send(commands))) {
      this.history.value = moved(this.history.value, by);
    }
  }

  /**
   * Sends commands after all that were sent before; if one fails, sends those that take them back.
   *
   * @param first what to do right before.
   */
  #send(
    commands: readonly Command[],
    takeBack: readonly Command[] = [],
    first: () => Promise<void> = () => Promise.resolve(),
  ): Promise<boolean> {
    const time = this.#time.peek();
    this.pending.value += 1;
    const sent = this.#queue.then(async () => {
      try {
        await first();
        for (const command of commands) await this.#service.perform(this.view, command, time);
        return true;
      } catch (error) {
        for (const command of takeBack) await this.#service.perform(this.view, command, time).catch(() => undefined);
        if (!isAbort(error)) this.#fail(error);
        return false;
      } finally {
        this.refresh();
        this.pending.value -= 1;
      }
    });
    this.#queue = sent;
    return sent;
  }
}
