/** Moves of the focus distance in the set from above, by pointer or keys. */

import type { Drag } from "../../editor/drag";
import { followPointer } from "../hooks";

export class FocusMoves {
  #held: { readonly drag: Drag<number>; readonly value: number } | null = null;
  #unfollow: (() => void) | null = null;

  /** Whether the distance is held, or a pointer is down on its handle. */
  get isTaken(): boolean {
    return this.#held !== null || this.#unfollow !== null;
  }

  /** The distance that is shown and not yet set; null where there is none. */
  get value(): number | null {
    return this.#held?.value ?? null;
  }

  /** Moves it with a pointer that is down until that is let go. */
  follow(down: PointerEvent, valueAt: (event: PointerEvent) => number, start: () => Drag<number>): void {
    this.#unfollow?.();
    this.#unfollow = followPointer(
      down,
      (event) => {
        this.move(valueAt(event), start);
      },
      ({ type }) => {
        this.end(type === "pointerup");
      },
    );
  }

  move(value: number, start: () => Drag<number>): void {
    const drag = this.#held?.drag ?? start();
    this.#held = { drag, value };
    drag.move(value);
  }

  /** Sets the distance, or leaves it as it was; a pointer that is still down moves it no more. */
  end(isSet: boolean): void {
    this.#unfollow?.();
    const last = this.#held;
    this.#unfollow = this.#held = null;
    if (isSet) last?.drag.commit(last.value);
    else last?.drag.cancel();
  }
}
