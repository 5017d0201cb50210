/** The focus points of a shot by time, each read once in a revision of its edits. */

import type { FocusPoint } from "../model/shot";
import { Recent } from "../net/recent";

/** Times whose points are kept. */
const MOST_KEPT = 512;

export class PointsByTime {
  readonly #read: (time: number) => Promise<readonly FocusPoint[]>;
  readonly #kept = new Recent<Promise<readonly FocusPoint[]>>(MOST_KEPT);

  constructor(read: (time: number) => Promise<readonly FocusPoint[]>) {
    this.#read = read;
  }

  at(time: number): Promise<readonly FocusPoint[]> {
    const known = this.known(time);
    if (known) return known;
    const points = this.#read(time);
    const name = time.toString();
    this.#kept.set(name, points);
    points.catch(() => {
      if (this.#kept.get(name) === points) this.#kept.delete(name);
    });
    return points;
  }

  /** The points at a time, where they were read, or are about to be. */
  known(time: number): Promise<readonly FocusPoint[]> | undefined {
    return this.#kept.get(time.toString());
  }

  /** Forgets the points, as those of another revision, but for those that came with an edit. */
  forget(after: { time: number; points: readonly FocusPoint[] } | null): void {
    this.#kept.clear();
    if (after) this.#kept.set(after.time.toString(), Promise.resolve(after.points));
  }
}
