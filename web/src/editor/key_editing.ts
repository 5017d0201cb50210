/** The keys of an open shot in lanes: which are selected, and the gestures on them. Each gesture is one edit. */

import { batch, computed, signal } from "@preact/signals";
import type { Changes } from "../model/changes";
import {
  holdShift,
  interpolated,
  interpolateStacks,
  lanesOf,
  mapKeys,
  MOST_CHANGES,
  movedStack,
  moveStacks,
  removeStacks,
  setKeyValue,
  snapShift,
  valued,
  type KeyStack,
} from "../model/key_lanes";
import type { Interpolation } from "../model/keys";
import type { FocusMode } from "../model/shot";
import { formatFrame } from "../model/time";
import { HintError } from "../net/errors";
import type { ShotDocument } from "./document";
import type { Fail } from "./fail";
import type { CameraPhotography } from "./photography";
import type { Playhead } from "./playhead";

const NONE: ReadonlySet<string> = new Set();

/** Parts of a session that keys are edited in. */
interface KeyedParts {
  readonly document: ShotDocument;
  readonly photography: CameraPhotography;
  readonly playhead: Playhead;
}

/** How far a pointer or a key has moved stacks. */
export interface KeyShift {
  /** Time codes. */
  readonly by: number;
  /** How near something must be to be snapped to, time codes; null does not snap, not even to frames. */
  readonly reach: number | null;
}

/** A drag of the selected stacks: it is seen in the picture, and its end is an edit. */
export interface KeyDrag {
  move(shift: KeyShift): void;
  /** Resolves to the time of the stack that was grabbed, once the service has it there; to null where it has not. */
  commit(shift: KeyShift): Promise<number | null>;
  cancel(): void;
}

/** The selected stacks as the edits under way leave them. */
interface Pending {
  /** Their ids as the service has them now. */
  readonly of: ReadonlySet<string>;
  readonly stacks: readonly KeyStack[];
  /** How far they are from where the service has them now, time codes. */
  readonly by: number;
}

/** Stacks that are shown elsewhere than the service has them. */
interface Shifted {
  readonly of: ReadonlySet<string>;
  /** Time codes. */
  readonly by: number;
}

export class KeyEditing {
  /** Ids of the selected stacks. */
  readonly selected = signal<ReadonlySet<string>>(NONE);
  /** The stacks that are dragged, until the service has them there. */
  readonly #shifted = signal<Shifted>({ of: NONE, by: 0 });
  readonly #parts: KeyedParts;
  readonly #fail: Fail;
  #pending: Pending | null = null;

  constructor(parts: KeyedParts, fail: Fail) {
    this.#parts = parts;
    this.#fail = fail;
  }

  readonly lanes = computed(() => {
    const { document, photography } = this.#parts;
    const current = photography.current.value;
    const keyed = [document.focusSettings.value?.keys, current?.exposure.keys, current?.film.keys];
    return lanesOf(
      keyed.filter((keys) => keys !== undefined),
      document.points.value,
    );
  });

  readonly selectedStacks = computed<readonly KeyStack[]>(() => {
    const selected = this.selected.value;
    return this.lanes.value.flatMap(({ stacks }) => stacks).filter(({ id }) => selected.has(id));
  });

  /** Reason why keys may not be edited; null where they may. */
  get noEdits(): string | null {
    return this.#parts.document.noEdits.value;
  }

  /** Where a stack is shown. */
  timeOf(stack: KeyStack): number {
    const { of, by } = this.#shifted.value;
    return of.has(stack.id) ? stack.time + by : stack.time;
  }

  /** Selects stacks in place of others; with `adds`, beside them, or no longer where all of them are selected. */
  select(stacks: readonly KeyStack[], adds = false): void {
    this.#forgetPending();
    const ids = stacks.map(({ id }) => id);
    const before = this.selected.value;
    if (!adds) this.selected.value = new Set(ids);
    else if (ids.every((id) => before.has(id)))
      this.selected.value = new Set([...before].filter((id) => !ids.includes(id)));
    else this.selected.value = new Set([...before, ...ids]);
  }

  /** Selects nothing; returns whether anything was selected. */
  clear(): boolean {
    this.#forgetPending();
    const had = this.selectedStacks.value.length > 0;
    this.selected.value = NONE;
    return had;
  }

  /**
   * Starts a drag of the selected stacks.
   *
   * @param grabbed stack under the pointer, which snaps.
   */
  drag(grabbed: KeyStack): KeyDrag {
    const base = this.#base();
    const { stacks } = base;
    const lanes = new Set(stacks.map(({ lane }) => lane));
    const from = grabbed.time + base.by;
    const { document, playhead } = this.#parts;
    // Not to the lane's other keys, which would be replaced.
    const others = this.lanes.peek().flatMap((lane) => (lanes.has(lane.id) ? [] : lane.stacks));
    const targets = [playhead.time.peek(), ...others.map(({ time }) => time)];
    const snapped = ({ by, reach }: KeyShift): number =>
      reach === null
        ? Number(holdShift(playhead.range, from, by).toFixed(2))
        : snapShift(playhead.range, from, by, targets, reach);
    return {
      move: (shift) => {
        const by = snapped(shift);
        const changes = moveStacks(stacks, by, this.#mode);
        playhead.pause();
        batch(() => {
          this.#show(base, by);
          if (changes.length <= MOST_CHANGES) document.preview(changes);
        });
      },
      commit: async (shift) => {
        const by = snapped(shift);
        return (await this.#move(base, by)) ? from + by : null;
      },
      cancel: () => {
        this.#show(base, 0);
        document.endPreview();
      },
    };
  }

  /** Moves the selected stacks together, so that the first one comes to a time of the shot. */
  moveTo(time: number): void {
    const base = this.#base();
    const first = Math.min(...base.stacks.map((stack) => stack.time));
    void this.#move(base, holdShift(this.#parts.playhead.range, first, time - first));
  }

  async remove(): Promise<void> {
    const { stacks } = this.#base();
    const before = this.selected.value;
    const isMade = await this.#edit(`Remove ${named(stacks)}`, removeStacks(stacks));
    if (isMade && this.selected.value === before) this.clear();
  }

  interpolate(interpolation: Interpolation): void {
    const base = this.#base();
    const after = mapKeys(base.stacks, (owned) => interpolated(owned, interpolation));
    const changes = interpolateStacks(base.stacks, interpolation, this.#mode);
    void this.#apply(`Interpolate ${named(base.stacks)}`, base, after, 0, changes);
  }

  /** Sets the value of the only selected key. */
  setValue(value: number): void {
    const base = this.#base();
    const [owned] = base.stacks.flatMap((stack) => stack.keys);
    if (!owned) return;
    const after = mapKeys(base.stacks, (one) => valued(one, value));
    void this.#apply("Value of a key", base, after, 0, setKeyValue(owned, value, this.#mode));
  }

  get #mode(): FocusMode {
    return this.#parts.document.readout.peek()?.focusMode ?? "manual";
  }

  /** The selected stacks, as the edits under way leave them. */
  #base(): Pending {
    if (this.#pending) return this.#pending;
    const stacks = this.selectedStacks.peek();
    return { of: new Set(stacks.map(({ id }) => id)), stacks, by: 0 };
  }

  /** Shows stacks so much farther than the edits under way leave them. */
  #show(base: Pending, by: number): void {
    // Where those edits are made meanwhile, the service has the stacks by other ids.
    const isUnderWay = this.#pending === base || base.by === 0;
    const of = isUnderWay ? base.of : new Set(base.stacks.map(({ id }) => id));
    this.#shifted.value = { of, by: (isUnderWay ? base.by : 0) + by };
  }

  /** Shows the keys where the service has them, though edits of them may be under way. */
  #forgetPending(): void {
    this.#pending = null;
    this.#shifted.value = { of: NONE, by: 0 };
  }

  /** Whether the newest edit under way is this one; with null, whether there is any. */
  #isUnderWay(pending: Pending | null): boolean {
    return this.#pending !== null && (pending === null || this.#pending === pending);
  }

  #move(base: Pending, by: number): Promise<boolean> {
    const after = base.stacks.map((stack) => movedStack(stack, by));
    return this.#apply(`Move ${named(base.stacks)}`, base, after, by, moveStacks(base.stacks, by, this.#mode));
  }

  /** Edits stacks, which stay selected as they are afterwards. */
  async #apply(
    label: string,
    base: Pending,
    after: readonly KeyStack[],
    by: number,
    changes: Changes,
  ): Promise<boolean> {
    this.#show(base, by);
    const pending: Pending = { ...this.#shifted.value, stacks: after };
    const ids = after.map(({ id }) => id);
    this.#pending = pending;
    this.selected.value = new Set([...pending.of, ...ids]); // those that the service will have, too
    const isMade = await this.#edit(label, changes);
    if (this.#isUnderWay(isMade ? pending : null)) {
      batch(() => {
        this.#forgetPending();
        this.selected.value = isMade ? new Set(ids) : pending.of;
      });
    }
    return isMade;
  }

  /** Makes an edit that the picture shows at once; resolves to whether it was made. */
  async #edit(label: string, changes: Changes): Promise<boolean> {
    const { document, playhead } = this.#parts;
    if (changes.length > MOST_CHANGES) {
      document.endPreview();
      const advice = `An edit takes some ${Math.floor((MOST_CHANGES - 1) / 2).toString()} keys: select fewer of them.`;
      this.#fail(new HintError("These are too many keys at once.", advice), () => undefined);
      return false;
    }
    playhead.pause();
    document.unsaved.value = changes;
    const edited = document.edit(label, changes, changes);
    document.dragging.value = false;
    const isMade = await edited;
    if (!isMade && document.unsaved.value === changes) document.endPreview();
    return isMade;
  }
}

function named(stacks: readonly KeyStack[]): string {
  const [only] = stacks;
  if (only && stacks.length === 1) return `the key at ${formatFrame(only.time)}`;
  return `${stacks.length.toString()} keys`;
}
