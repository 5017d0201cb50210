/** How the picture is enlarged on screen; kept while its shot is open. */

import { computed, signal } from "@preact/signals";
import { fitScale, movedBy, scaledTo, withPlace, type Placing, type Room } from "../model/zoom";
import type { Place } from "./picks";

const MIDDLE: Place = [0.5, 0.5];
/** Factor of a step by a command. */
const STEP = Math.SQRT2;

export class Zoom {
  /** How it is enlarged; null as a whole. */
  readonly placing = signal<Placing | null>(null);
  /** Device pixels for each pixel of the delivered picture; null where all of it is shown. */
  readonly scale = computed(() => this.placing.value?.scale ?? null);
  /** Whether there is a loupe at the pointer or the crosshair. */
  readonly loupe = signal(false);
  /** What the picture has to stand in; null until it is known. */
  room: Room | null = null;

  fit(): void {
    this.placing.value = null;
  }

  /** Goes to 1:1 about a place, or back to the whole picture. */
  toggle(about: Place | null): void {
    if (this.placing.value) this.fit();
    else this.#scale(1, about);
  }

  /** Enlarges by a factor about a place, which stays where it is. */
  by(factor: number, about: Place | null): void {
    if (this.room) this.#scale((this.placing.value?.scale ?? fitScale(this.room)) * factor, about);
  }

  /** Enlarges by a step, or with -1 goes back by one. */
  step(way: 1 | -1, about: Place | null): void {
    this.by(STEP ** way, about);
  }

  /** Moves an enlarged picture by CSS px. */
  move(x: number, y: number): void {
    if (this.room && this.placing.value) this.placing.value = movedBy(this.room, this.placing.value, x, y);
  }

  /** Moves an enlarged picture as little as brings a place of it into view. */
  reveal(place: Place): void {
    const placing = this.placing.peek();
    if (this.room && placing) this.placing.value = withPlace(this.room, placing, place);
  }

  #scale(scale: number, about: Place | null): void {
    if (this.room) this.placing.value = scaledTo(this.room, this.placing.value, scale, about ?? MIDDLE);
  }
}
