/** Pulls of the focus: what a click means, and the last one, which can still be changed. */

import { computed, signal, type ReadonlySignal, type Signal } from "@preact/signals";
import { setAttribute, setWeights, type Changes } from "../model/changes";
import { pulledWeights, pullSpan, type Pull, type Reach } from "../model/pull";
import type { Ease, FocusPoint } from "../model/shot";
import type { ShotDocument } from "./document";

/** What a click means, as the person chose. */
export interface PullChoice {
  readonly reach: Signal<Reach>;
  readonly frames: Signal<number>;
  readonly ease: Signal<Ease>;
}

/** In a second's half over to what was clicked, and to stay there. */
export function usualPull(): PullChoice {
  return { reach: signal("from"), frames: signal(12), ease: signal("smooth") };
}

/** A pull that has been made. */
interface Made {
  readonly name: string;
  readonly label: string;
  readonly gesture: string;
  readonly time: number;
  readonly pull: Pull;
  /** The points before it. */
  readonly points: readonly FocusPoint[];
  /** The revision that it led to. */
  readonly revision: number;
}

/** Most frames in which the focus goes over. */
export const MOST_FRAMES = 1000;

export class Pulls {
  readonly choice: PullChoice;
  /** Whether a button is down on the picture, so that the times of the pull that follows are shown. */
  readonly aiming = signal(false);
  readonly #document: ShotDocument;
  readonly #time: ReadonlySignal<number>;
  readonly #made = signal<Made | null>(null);
  #count = 0;

  constructor(document: ShotDocument, time: ReadonlySignal<number>, choice: PullChoice) {
    [this.#document, this.#time, this.choice] = [document, time, choice];
  }

  /** The last edit, where it was a pull and no other is under way. */
  readonly last = computed(() => {
    const { revision, pending } = this.#document;
    const made = this.#made.value;
    return made?.revision === revision.value && pending.value === 0 ? made : null;
  });

  /** Times of the pull that a click would make, or of the last one. */
  readonly span = computed(() => {
    const { points, shot } = this.#document;
    const { name, time, pull, points: before } = this.last.value ?? {};
    if (this.aiming.value) return pullSpan(null, this.#time.value, points.value, this.#chosen.value, shot.range);
    return pull && before && time !== undefined ? pullSpan(name ?? null, time, before, pull, shot.range) : null;
  });

  readonly #chosen = computed<Pull>(() => ({
    reach: this.choice.reach.value,
    frames: this.choice.frames.value,
    ease: this.choice.ease.value,
  }));

  /**
   * Gives a point the focus.
   *
   * @param points at the time; where the point is new it is not among them.
   * @param before changes that come before the pull, such as what makes the point.
   */
  async pull(name: string, time: number, points: readonly FocusPoint[], before: Changes = []): Promise<boolean> {
    const pull = this.#chosen.peek();
    this.#count += 1;
    const gesture = `pull ${Date.now().toString(36)} ${this.#count.toString()}`;
    const label = `Focus on ${name}`;
    const changes = [...before, ...this.#changes(name, time, pull, points, points)];
    if (!(await this.#document.edit(label, changes, undefined, gesture))) return false;
    const revision = this.#document.revision.peek();
    this.#made.value = { name, label, gesture, time, pull, points, revision };
    return true;
  }

  /** Gives a point that is there already the focus. */
  pullTo(point: FocusPoint, time: number): Promise<boolean> {
    const on = point.settings.enabled ? [] : setAttribute(point, "enabled", 1, time);
    return this.pull(point.name, time, this.#document.points.peek(), [...this.#document.byPoints(), ...on]);
  }

  /** Makes the last pull again in another way, as a part of its step of undo, and later ones in that way. */
  async change(change: Partial<Pull>): Promise<void> {
    const last = this.last.peek();
    const { reach, frames, ease } = { ...this.#chosen.peek(), ...change };
    [this.choice.reach.value, this.choice.frames.value, this.choice.ease.value] = [reach, frames, ease];
    if (!last) return;
    const pull = { ...last.pull, ...change };
    const now = await this.#document.pointsAt(last.time);
    const changes = this.#changes(last.name, last.time, pull, last.points, now);
    if (await this.#document.edit(last.label, changes, undefined, last.gesture))
      this.#made.value = { ...last, pull, revision: this.#document.revision.peek() };
  }

  /** The changes that make of the points as they are now what a pull makes of those before it. */
  #changes(name: string, time: number, pull: Pull, before: readonly FocusPoint[], now: readonly FocusPoint[]): Changes {
    return setWeights(pulledWeights(name, time, before, pull, this.#document.shot.range), before, now, time);
  }
}
