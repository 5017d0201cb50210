/** The focus points of a shot by time, each read once in a revision of its edits. */

import type { FocusPoint } from "../model/shot";
import { Recent } from "../net/recent";

/** Times whose points are kept. */
const MOST_KEPT = 512;

export class PointsByTime {
  readonly #read: (time: number) => Promise<readonly FocusPoint[]>;
  readonly #kept = new Recent<Promise<readonly FocusPoint[]>>(MOST_KEPT);
  readonly #there = new Recent<readonly FocusPoint[]>(MOST_KEPT);

  constructor(read: (time: number) => Promise<readonly FocusPoint[]>) {
    this.#read = read;
  }

  at(time: number): Promise<readonly FocusPoint[]> {
    const name = time.toString();
    const kept = this.#kept.get(name);
    if (kept) return kept;
    const points = this.#read(time);
    this.#kept.set(name, points);
    points.then(
      (read) => {
        if (this.#kept.get(name) === points) this.#there.set(name, read);
      },
      () => {
        if (this.#kept.get(name) === points) this.#kept.delete(name);
      },
    );
    return points;
  }

  /** The points at a time, where they are there already. */
  known(time: number): readonly FocusPoint[] | undefined {
    return this.#there.get(time.toString());
  }

  /** Forgets the points, as those of another revision, but for those that came with an edit. */
  forget(after: { time: number; points: readonly FocusPoint[] } | null): void {
    this.#kept.clear();
    this.#there.clear();
    if (!after) return;
    this.#kept.set(after.time.toString(), Promise.resolve(after.points));
    this.#there.set(after.time.toString(), after.points);
  }
}
