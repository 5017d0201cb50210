/** Moves of a focus point in the set from above, by pointer or keys, each of which may begin before the one before it is saved. */

import type { PlanDrag } from "../../editor/plan_drag";
import type { Place } from "../../model/top_view";

/** A drag, and where it has come. */
interface Move {
  readonly drag: PlanDrag;
  readonly place: Place;
}

export class PlanMoves {
  readonly #show: (place: Place | null) => void;
  #held: Move | null = null;
  /** The last one that was dropped and is not saved yet. */
  #dropped: Move | null = null;
  #unfollow: (() => void) | null = null;

  /** @param show shows the point at a place; null shows it where it is saved. */
  constructor(show: (place: Place | null) => void) {
    this.#show = show;
  }

  get isHeld(): boolean {
    return this.#held !== null;
  }

  /** Whether the point is held, or a pointer is down on it. */
  get isTaken(): boolean {
    return this.isHeld || this.#unfollow !== null;
  }

  /** Where the point has been moved to; null where that is saved. */
  get place(): Place | null {
    return (this.#held ?? this.#dropped)?.place ?? null;
  }

  /** Takes hold of a pointer. @param unfollow lets go of it. */
  follow(unfollow: () => void): void {
    this.#unfollow?.();
    this.#unfollow = unfollow;
  }

  /** Moves the point on, or begins to. */
  move(to: Place, start: () => PlanDrag): void {
    const drag = this.#held?.drag ?? start();
    this.#held = { drag, place: to };
    this.#show(to);
    drag.move(to);
  }

  /** Ends the move under way, and lets go of the pointer; until a place is saved the point is shown there. */
  async end(isDropped: boolean): Promise<void> {
    this.#unfollow?.();
    this.#unfollow = null;
    const move = this.#held;
    this.#held = null;
    if (!move) return;
    if (isDropped) {
      this.#dropped = move;
      await move.drag.drop();
      if (this.#dropped === move) this.#dropped = null; // else another one was dropped after it
    } else move.drag.cancel();
    this.#show(this.place);
  }
}
