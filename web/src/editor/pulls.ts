/** Pulls of the focus: what a click means, and the last one, which can still be changed. */

import { batch, computed, signal, type ReadonlySignal, type Signal } from "@preact/signals";
import { setAttribute, setWeights, type Changes } from "../model/changes";
import { pulledWeights, pullSpan, startOf, type Pull, type Reach } from "../model/pull";
import type { Ease, FocusPoint } from "../model/shot";
import type { ShotDocument } from "./document";
import { noPointHint } from "./hints";
import type { PointNames } from "./point_names";

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
  /** What it is called by then. */
  readonly nameNow: () => string;
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
  readonly #names: PointNames;
  readonly #made = signal<Made | null>(null);
  /** Edits of pulls that are under way. */
  readonly #saving = signal(0);
  #count = 0;

  constructor(document: ShotDocument, time: ReadonlySignal<number>, names: PointNames, choice: PullChoice) {
    [this.#document, this.#time, this.#names, this.choice] = [document, time, names, choice];
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
    const { nameNow, time, pull, points: before } = this.last.value ?? {};
    if (this.aiming.value) return pullSpan(null, this.#time.value, points.value, this.#chosen.value, shot.range);
    return pull && before && time !== undefined ? pullSpan(nameNow?.() ?? null, time, before, pull, shot.range) : null;
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
  pull(name: string, time: number, before: Changes = []): Promise<boolean> {
    return this.#begin(name, time, () => before);
  }

  /** Gives a point that is there already the focus, unless it is gone by then. */
  pullTo(point: FocusPoint, time: number): Promise<boolean> {
    const [from, byPoints] = [startOf(time, this.#chosen.peek(), this.#document.shot.range), this.#document.byPoints()];
    return this.#begin(point.name, time, (points, name) => {
      const now = points.find((one) => one.name === name);
      if (!now) throw noPointHint(point.name);
      return [...byPoints, ...(now.settings.enabled ? [] : setAttribute(now, "enabled", 1, from))];
    });
  }

  /** @param before makes, of the points and the name of this one as they are then, the changes that come before the pull. */
  #begin(
    name: string,
    time: number,
    before: (points: readonly FocusPoint[], name: string) => Changes,
  ): Promise<boolean> {
    const pull = this.#chosen.peek();
    this.#count += 1;
    const gesture = `pull ${Date.now().toString(36)} ${this.#count.toString()}`;
    const nameNow = this.#names.follow(name);
    const begun = { name, nameNow, label: `Focus on ${name}`, gesture, time, pull };
    this.#made.value = null;
    return this.#save(begun, (points) => [
      points,
      [...before(points, nameNow()), ...this.#changes(begun, points, points)],
    ]);
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
    { nameNow, time, pull }: Pick<Made, "nameNow" | "time" | "pull">,
    before: readonly FocusPoint[],
    now: readonly FocusPoint[],
  ): Changes {
    return setWeights(pulledWeights(nameNow(), time, before, pull, this.#document.shot.range), before, now, time);
  }
}
