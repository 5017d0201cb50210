/** The crosshair on the picture, which the arrow keys move: a pointer for the keyboard. */

import { signal } from "@preact/signals";
import type { Place } from "./picks";

/** Part of the picture's width and height that a press of an arrow key goes, and with Shift. */
const STEP = 0.01;
const LEAP = 0.1;

const WAYS: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

export class Crosshair {
  /** Where it is, 0 to 1 from the top left corner of the picture; null until it was moved there. */
  readonly at = signal<Place | null>(null);
  /** Whether the keyboard is on the picture, so that the crosshair is shown and the arrow keys are for it. */
  readonly isHeld = signal(false);

  hold(): void {
    this.at.value ??= [0.5, 0.5];
    this.isHeld.value = true;
  }

  letGo(): void {
    this.isHeld.value = false;
  }

  /** Moves it by an arrow key; returns whether it was one and the crosshair is held. */
  move(key: string, leaps: boolean): boolean {
    const way = WAYS[key];
    if (!way || !this.isHeld.value || !this.at.value) return false;
    const by = leaps ? LEAP : STEP;
    const [x, y] = this.at.value;
    this.at.value = [within(x + way[0] * by), within(y + way[1] * by)];
    return true;
  }
}

function within(place: number): number {
  return Number(Math.min(Math.max(place, 0), 0.999).toFixed(4));
}
