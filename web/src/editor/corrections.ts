/** Corrections of dense curves: a value that is set at a frame bends the curve around it, as widely as the person says. */

import { computed, signal } from "@preact/signals";
import type { Changes } from "../model/changes";
import { correct, isDense, recorrect, type Correction } from "../model/correction";
import type { ValueOwner } from "../model/key_lanes";
import type { Key } from "../model/keys";
import { followOwner, type ReadKeys } from "./current_keys";
import type { ShotDocument } from "./document";
import type { Drag } from "./drag";
import { goneHint } from "./hints";
import type { PointNames } from "./point_names";

/** A curve, and where a value of it is set. */
export interface CurvePlace {
  readonly owner: ValueOwner;
  readonly keys: readonly Key[];
  /** USD time code. */
  readonly time: number;
}

/** A correction that has been made. */
interface Made extends Correction {
  readonly label: string;
  readonly gesture: string;
  /** How far it reaches, frames. */
  readonly width: number;
  /** The revision that it led to. */
  readonly revision: number;
}

export class Corrections {
  /** How far a correction reaches before and after its frame, frames. */
  readonly width = signal(12);
  readonly #document: ShotDocument;
  readonly #read: ReadKeys;
  readonly #names: PointNames;
  readonly #made = signal<Made | null>(null);
  #count = 0;

  constructor(document: ShotDocument, read: ReadKeys, names: PointNames) {
    [this.#document, this.#read, this.#names] = [document, read, names];
  }

  /** The last edit, where it was a correction and no other is under way; its width can still be changed. */
  readonly last = computed(() => {
    const { revision, pending } = this.#document;
    const made = this.#made.value;
    return made?.revision === revision.value && pending.value === 0 ? made : null;
  });

  /**
   * Starts a drag of a value. On a dense curve it bends the curve around its time.
   *
   * @param plain changes that set the value elsewhere.
   * @param made those of the edit, where something has to be read for them.
   */
  drag(
    label: string,
    at: CurvePlace,
    plain: (value: number) => Changes,
    made?: (value: number) => () => Promise<Changes>,
  ): Drag<number> {
    if (!isDense(at.keys, at.time)) {
      const drag = this.#document.drag(label, plain);
      return made ? { ...drag, commit: (value) => void this.#edit(label, plain(value), made(value)) } : drag;
    }
    const to = (value: number): Correction => ({ ...at, value });
    const drag = this.#document.drag(label, (value: number) => correct(to(value), this.width.peek()));
    return { ...drag, commit: (value) => void this.#make(label, to(value)) };
  }

  /** Makes the last correction again, more or less widely, as a part of its step of undo. */
  async widen(width: number): Promise<void> {
    const last = this.last.peek();
    this.width.value = width;
    if (!last) return;
    const changes = recorrect(last, last.width, width);
    if (await this.#document.edit(last.label, changes, undefined, last.gesture))
      this.#made.value = { ...last, width, revision: this.#document.revision.peek() };
  }

  /** Ends a drag with an edit. */
  #edit(
    label: string,
    unsaved: Changes,
    changes: Changes | (() => Promise<Changes>),
    gesture?: string,
  ): Promise<boolean> {
    this.#document.unsaved.value = unsaved;
    const edited = this.#document.edit(label, changes, unsaved, gesture);
    this.#document.dragging.value = false;
    return edited;
  }

  async #make(label: string, shown: Correction): Promise<void> {
    const document = this.#document;
    const width = this.width.peek();
    this.#count += 1;
    const gesture = `correction ${Date.now().toString(36)} ${this.#count.toString()}`;
    let correction = shown;
    const unsaved = correct(shown, width);
    const owner = followOwner(shown.owner, this.#names);
    // Where other edits are under way, or have just been made, they may be of the same curve.
    const changes =
      document.pending.peek() === 0 && document.hasFreshPoints
        ? unsaved
        : async () => {
            const keys = await this.#read(owner());
            if (keys === null) throw goneHint(owner());
            correction = { ...shown, owner: owner(), keys };
            return correct(correction, width);
          };
    if (await this.#edit(label, unsaved, changes, gesture))
      this.#made.value = { ...correction, label, gesture, width, revision: document.revision.peek() };
  }
}
