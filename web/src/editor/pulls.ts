/** Pulls of the focus: what a click means, and the last one, which can still be changed. */

import { batch, computed, signal, type ReadonlySignal, type Signal } from "@preact/signals";
import { setAttribute, setWeights, type Changes } from "../model/changes";
import { pulledWeights, pullSpan, startOf, type Pull, type Reach } from "../model/pull";
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
  /** Edits of pulls that are under way. */
  readonly #saving = signal(0);
  #count = 0;

  constructor(document: ShotDocument, time: ReadonlySignal<number>, choice: PullChoice) {
    [this.#document, this.#time, this.choice] = [document, time, choice];
  }

  /** The last edit, where it was a pull; it may be on its way. */
  readonly last = computed(() => {
    const { revision, pending } = this.#document;
    const made = this.#made.value;
    const isSaved = made?.revision === revision.value && pending.value === 0;
    const isOnItsWay = this.#saving.value > 0 && pending.value === this.#saving.value;
    return isSaved || isOnItsWay ? made : null;
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
   * @param name of the point; it may be new.
   * @param before changes that come before the pull, such as what makes the point.
   */
  async pull(name: string, time: number, before: Changes = []): Promise<boolean> {
    const pull = this.#chosen.peek();
    this.#count += 1;
    const gesture = `pull ${Date.now().toString(36)} ${this.#count.toString()}`;
    const begun = { name, label: `Focus on ${name}`, gesture, time, pull };
    this.#made.value = null;
    return this.#save(begun, (points) => [points, [...before, ...this.#changes(begun, points, points)]]);
  }

  /** Gives a point that is there already the focus. */
  pullTo(point: FocusPoint, time: number): Promise<boolean> {
    const from = startOf(time, this.#chosen.peek(), this.#document.shot.range);
    const on = point.settings.enabled ? [] : setAttribute(point, "enabled", 1, from);
    return this.pull(point.name, time, [...this.#document.byPoints(), ...on]);
  }

  /** Makes the last pull again in another way, as a part of its step of undo, and later ones in that way. */
  async change(change: Partial<Pull>): Promise<void> {
    const { reach, frames, ease } = { ...this.#chosen.peek(), ...change };
    [this.choice.reach.value, this.choice.frames.value, this.choice.ease.value] = [reach, frames, ease];
    const last = this.last.peek();
    if (!last) return;
    const changed = { ...last, pull: { ...last.pull, ...change } };
    this.#made.value = changed;
    await this.#save(changed, (now) => [last.points, this.#changes(changed, last.points, now)]);
  }

  /**
   * Makes the edit of a pull after those before it.
   *
   * @param make makes, of the points as they are then, the points before the pull and the changes.
   */
  async #save(
    pull: Omit<Made, "points" | "revision">,
    make: (points: readonly FocusPoint[]) => readonly [readonly FocusPoint[], Changes],
  ): Promise<boolean> {
    let before: readonly FocusPoint[] = [];
    const changes = async (): Promise<Changes> => {
      const [points, made] = make(await this.#document.pointsAt(pull.time));
      before = points;
      return made;
    };
    this.#saving.value += 1;
    const isMade = await this.#document.edit(pull.label, changes, undefined, pull.gesture);
    batch(() => {
      this.#saving.value -= 1;
      const revision = this.#document.revision.peek();
      const newer = this.#made.peek()?.gesture === pull.gesture ? this.#made.peek() : null;
      this.#made.value = isMade ? { ...(newer ?? pull), points: before, revision } : null;
    });
    return isMade;
  }

  /** The changes that make of the points as they are now what a pull makes of those before it. */
  #changes(
    { name, time, pull }: Pick<Made, "name" | "time" | "pull">,
    before: readonly FocusPoint[],
    now: readonly FocusPoint[],
  ): Changes {
    return setWeights(pulledWeights(name, time, before, pull, this.#document.shot.range), before, now, time);
  }
}
