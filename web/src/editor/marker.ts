/** The drag of a focus point's marker: the picture previews the focus at the pointer. */

import type { FocusPoint } from "../model/shot";
import type { Session } from "./session";

type Place = readonly [number, number];

export class MarkerDrag {
  readonly #session: Session;
  readonly #point: FocusPoint;
  #last: Place | null = null;

  constructor(session: Session, point: FocusPoint) {
    [this.#session, this.#point] = [session, point];
  }

  /** @param at 0 to 1 from the picture's top left. */
  move(at: Place): void {
    const { name } = this.#point;
    this.#last = at;
    this.#session.selected.value = name;
    this.#session.document.preview([{ type: "movePoint", name, place: at, time: this.#session.playhead.time.peek() }]);
  }

  /** Puts the point there. */
  async drop(): Promise<void> {
    const { document } = this.#session;
    if (!this.#last) return;
    const unsaved = document.unsaved.peek();
    document.dragging.value = false;
    await this.#session.click(this.#last, "move");
    if (document.unsaved.peek() === unsaved) document.endPreview(); // there was nothing to put it on
  }

  cancel(): void {
    this.#session.document.endPreview();
  }
}
