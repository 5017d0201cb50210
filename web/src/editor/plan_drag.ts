/** The drag of a focus point in the set from above: it keeps its height, and the picture previews the focus there. */

import { moveInWorld, type Changes } from "../model/changes";
import type { FocusPoint } from "../model/shot";
import { movedTo, type Place, type TopView } from "../model/top_view";
import type { Vector } from "../model/vector";
import type { Session } from "./session";

export class PlanDrag {
  readonly #session: Session;
  readonly #point: FocusPoint;
  readonly #view: TopView;
  readonly #from: Vector;
  readonly #time: number;
  #last: { readonly positionM: Vector; readonly unsaved: Changes } | null = null;

  /** @param view the camera at the point's time. */
  constructor(session: Session, point: FocusPoint & { readonly positionM: Vector }, view: TopView) {
    [this.#session, this.#point, this.#view] = [session, point, view];
    [this.#from, this.#time] = [point.positionM, session.playhead.time.peek()];
  }

  move(to: Place): void {
    const { document, playhead, selected } = this.#session;
    playhead.pause();
    const positionM = movedTo(this.#view, this.#from, to);
    const unsaved = moveInWorld(this.#point.name, positionM, this.#time);
    this.#last = { positionM, unsaved };
    selected.value = this.#point.name;
    document.preview(unsaved);
  }

  /** Puts the point there. */
  async drop(): Promise<void> {
    if (!this.#last) return;
    const { positionM, unsaved } = this.#last;
    this.#session.document.dragging.value = false;
    await this.#session.pointEdits.moveInWorld(this.#point, positionM, this.#time, unsaved);
    this.cancel(); // where it could not be
  }

  /** Shows the saved state again, unless something else is shown. */
  cancel(): void {
    const { document } = this.#session;
    if (document.unsaved.peek() === this.#last?.unsaved) document.endPreview();
  }
}

/** Stop of the playing shot before a drag, which begins once point and camera are known at the frame where it stopped. */
export class Standstill {
  readonly #session: Session;
  #isDue = false;

  constructor(session: Session) {
    this.#session = session;
  }

  /** Stops playing; returns whether a point and the camera are those of the present frame. */
  comesWith(point: FocusPoint, view: TopView): boolean {
    const { document, playhead, topView } = this.#session;
    if (playhead.playing.peek()) {
      playhead.pause();
      this.#isDue = true;
    }
    const isKnown = document.hasFreshPoints && !topView.reading.peek();
    if (isKnown && document.points.peek().includes(point) && topView.view.peek() === view) this.#isDue = false;
    return !this.#isDue;
  }
}
