/** Corrections of dense curves: a value that is set at a frame bends the curve around it, as widely as the person says. */

import { computed, signal } from "@preact/signals";
import { correct, type Correction } from "../model/correction";
import type { Key, KeyedSetting } from "../model/keys";
import type { Drag, ShotDocument } from "./document";

/** A correction that has been made. */
interface Made extends Correction {
  readonly label: string;
  /** The revision that it led to. */
  readonly revision: number;
}

export class Corrections {
  /** How far a correction reaches before and after its frame, frames. */
  readonly width = signal(12);
  readonly #document: ShotDocument;
  readonly #made = signal<Made | null>(null);

  constructor(document: ShotDocument) {
    this.#document = document;
  }

  /** The last edit, where it was a correction; its width can still be changed. */
  readonly last = computed(() =>
    this.#made.value?.revision === this.#document.revision.value ? this.#made.value : null,
  );

  /** Starts a drag of the value that a curve is to have at a time. */
  drag(label: string, setting: KeyedSetting, keys: readonly Key[], time: number): Drag<number> {
    const to = (value: number): Correction => ({ setting, keys, time, value });
    const drag = this.#document.drag(label, (value: number) => correct(to(value), this.width.peek()));
    return { ...drag, commit: (value) => void this.#make(label, to(value)) };
  }

  /** Makes the last correction again, more or less widely. */
  async widen(width: number): Promise<void> {
    const last = this.last.peek();
    this.width.value = width;
    if (last && (await this.#document.undo())) await this.#make(last.label, last);
  }

  async #make(label: string, correction: Correction): Promise<void> {
    const document = this.#document;
    const changes = correct(correction, this.width.peek());
    document.unsaved.value = changes;
    const edited = document.edit(label, changes, changes);
    document.dragging.value = false;
    if (await edited) this.#made.value = { ...correction, label, revision: document.revision.peek() };
  }
}
