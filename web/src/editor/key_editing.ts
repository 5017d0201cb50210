/** The keys of an open shot in lanes: which are selected, and the gestures on them. Each gesture is one edit. */

import { batch, computed, signal } from "@preact/signals";
import type { Changes } from "../model/changes";
import {
  interpolateStacks,
  lanesOf,
  MOST_CHANGES,
  movedStack,
  moveStacks,
  removeStacks,
  setKeyValue,
  snapShift,
  type KeyStack,
  type OwnedKey,
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

/** Stacks whose moves are under way: as the service will have them, and how far that is from where it has them now. */
interface Moving {
  readonly stacks: readonly KeyStack[];
  readonly by: number;
}

export class KeyEditing {
  /** Ids of the selected stacks. */
  readonly selected = signal<ReadonlySet<string>>(NONE);
  /** How far the selected stacks are dragged, time codes, until the service has them there. */
  readonly shift = signal(0);
  readonly #parts: KeyedParts;
  readonly #fail: Fail;
  #moving: Moving | null = null;

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

  /** Where a stack is shown. */
  timeOf(stack: KeyStack): number {
    return this.selected.value.has(stack.id) ? stack.time + this.shift.value : stack.time;
  }

  /** Selects stacks in place of others; with `adds`, beside them, or no longer where all of them are selected. */
  select(stacks: readonly KeyStack[], adds = false): void {
    this.#forgetMove();
    const ids = stacks.map(({ id }) => id);
    const before = this.selected.value;
    if (!adds) this.selected.value = new Set(ids);
    else if (ids.every((id) => before.has(id)))
      this.selected.value = new Set([...before].filter((id) => !ids.includes(id)));
    else this.selected.value = new Set([...before, ...ids]);
  }

  /** Selects nothing; returns whether anything was selected. */
  clear(): boolean {
    this.#forgetMove();
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
    const own = new Set(stacks.map(({ id }) => id));
    const from = grabbed.time + base.by;
    const { document, playhead } = this.#parts;
    const others = this.lanes.peek().flatMap((lane) => lane.stacks.filter(({ id }) => !own.has(id)));
    const targets = [playhead.time.peek(), ...others.map(({ time }) => time)];
    const snapped = ({ by, reach }: KeyShift): number =>
      reach === null ? Number(by.toFixed(2)) : snapShift(playhead.range, from, by, targets, reach);
    return {
      move: (shift) => {
        const by = snapped(shift);
        const changes = moveStacks(stacks, by, this.#mode);
        batch(() => {
          this.shift.value = this.#shiftOf(base) + by;
          if (changes.length <= MOST_CHANGES) document.preview(changes);
        });
      },
      commit: async (shift) => {
        const by = snapped(shift);
        return (await this.#move(base, by)) ? from + by : null;
      },
      cancel: () => {
        this.shift.value = this.#shiftOf(base);
        document.endPreview();
      },
    };
  }

  /** Moves the selected stacks together, so that the first one comes to a time. */
  moveTo(time: number): void {
    const base = this.#base();
    void this.#move(base, time - Math.min(...base.stacks.map((stack) => stack.time)));
  }

  remove(): void {
    const { stacks } = this.#base();
    this.clear();
    void this.#edit(`Remove ${named(stacks)}`, removeStacks(stacks));
  }

  interpolate(interpolation: Interpolation): void {
    const { stacks } = this.#base();
    void this.#edit(`Interpolate ${named(stacks)}`, interpolateStacks(stacks, interpolation, this.#mode));
  }

  /** Sets the value of a selected key. */
  setValue({ owner, key }: OwnedKey, value: number): void {
    const now: OwnedKey = { owner, key: { ...key, time: key.time + this.#base().by } };
    void this.#edit("Value of a key", setKeyValue(now, value, this.#mode));
  }

  get #mode(): FocusMode {
    return this.#parts.document.readout.peek()?.focusMode ?? "manual";
  }

  /** The selected stacks, where the edits under way leave them. */
  #base(): Moving {
    return this.#moving ?? { stacks: this.selectedStacks.peek(), by: 0 };
  }

  /** How far stacks are from where the service has them now. */
  #shiftOf(base: Moving): number {
    return this.#moving === base ? base.by : 0;
  }

  /** Shows the keys where the service has them, though moves of them may be under way. */
  #forgetMove(): void {
    this.#moving = null;
    this.shift.value = 0;
  }

  async #move(base: Moving, by: number): Promise<boolean> {
    const { stacks } = base;
    const moving: Moving = { stacks: stacks.map((stack) => movedStack(stack, by)), by: this.#shiftOf(base) + by };
    this.#moving = moving;
    this.shift.value = moving.by;
    const isMoved = await this.#edit(`Move ${named(stacks)}`, moveStacks(stacks, by, this.#mode));
    if (this.#moving === moving || !isMoved) {
      batch(() => {
        this.#forgetMove();
        if (isMoved) this.selected.value = new Set(moving.stacks.map(({ id }) => id));
      });
    }
    return isMoved;
  }

  /** Makes an edit that the picture shows at once; resolves to whether it was made. */
  async #edit(label: string, changes: Changes): Promise<boolean> {
    const { document } = this.#parts;
    if (changes.length > MOST_CHANGES) {
      document.endPreview();
      const advice = `An edit takes some ${Math.floor((MOST_CHANGES - 1) / 2).toString()} keys: select fewer of them.`;
      this.#fail(new HintError("These are too many keys at once.", advice), () => undefined);
      return false;
    }
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
