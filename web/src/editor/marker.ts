/** The drag of a focus point's marker: the picture previews the focus at the pointer. */

import { moveOnto, type Changes } from "../model/changes";
import type { FocusPoint } from "../model/shot";
import type { Place } from "./picks";
import type { Session } from "./session";

export class MarkerDrag {
  readonly #session: Session;
  readonly #point: FocusPoint;
  #last: { readonly at: Place; readonly unsaved: Changes } | null = null;

  constructor(session: Session, point: FocusPoint) {
    [this.#session, this.#point] = [session, point];
  }

  move(at: Place): void {
    const { document, playhead, selected } = this.#session;
    const unsaved = moveOnto(this.#point, { place: at }, playhead.time.peek());
    this.#last = { at, unsaved };
    selected.value = this.#point.name;
    document.preview(unsaved);
  }

  /** Puts the point there. */
  async drop(): Promise<void> {
    if (!this.#last) return;
    const { at, unsaved } = this.#last;
    this.#session.document.dragging.value = false;
    await this.#session.picks.move(this.#point.name, at, unsaved);
    this.cancel(); // where there was nothing to put it on
  }

  /** Shows the saved state again, unless something else is shown. */
  cancel(): void {
    const { document } = this.#session;
    if (document.unsaved.peek() === this.#last?.unsaved) document.endPreview();
  }
}
