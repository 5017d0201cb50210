/** The focus curve of a shot, solved by the service once for each revision. */

import { signal } from "@preact/signals";
import type { Curve } from "../model/curve";
import { NewestWins } from "../net/newest";

export class SolvedCurve {
  readonly samples = signal<Curve>([]);
  /** Revision of the document that it is of. */
  readonly revision = signal(-1);
  /** Whether it is being solved. */
  readonly solving = signal(false);
  readonly #follow: NewestWins<number, Curve>;

  constructor(solve: (abort: AbortSignal) => Promise<Curve>, onError: (error: unknown) => void) {
    this.#follow = new NewestWins({
      load: (_, abort) => solve(abort),
      onResult: (curve, revision) => {
        [this.samples.value, this.revision.value] = [curve, revision];
      },
      onError,
      onBusy: (isBusy) => (this.solving.value = isBusy),
      mostInFlight: 1,
    });
  }

  /** Solves that of a revision. */
  solve(revision: number): void {
    this.#follow.load(revision);
  }

  /** Takes one that has come with something else. */
  take(curve: Curve, revision: number): void {
    this.stop();
    [this.samples.value, this.revision.value] = [curve, revision];
  }

  /** Stops solving; the curve before stays. */
  stop(): void {
    this.#follow.clear();
  }
}
