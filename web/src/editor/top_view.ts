/** The set from above, followed while it is shown. */

import { computed, effect, signal, type ReadonlySignal } from "@preact/signals";
import { withReadout, type Paths, type Sheet, type TopView } from "../model/top_view";
import { frameDrawn } from "../net/frame_drawn";
import { NewestWins } from "../net/newest";
import type { Service } from "../net/service";
import type { At, ShotDocument } from "./document";
import type { Fail } from "./fail";

/** The drawing as it was left. */
export interface LeftSheet extends Pick<Sheet, "pxPerM" | "middle"> {
  /** Whether it shows all, and nobody has moved it since. */
  readonly isFitted: boolean;
}

export class TopViewer {
  /** Whether it is on screen; only then is it read. */
  readonly isShown = signal(false);
  readonly paths = signal<Paths | null>(null);
  /** Whether the camera is being read. */
  readonly reading = signal(false);
  /** Scale and middle of the drawing; null where it is to show all. */
  readonly sheet = signal<LeftSheet | null>(null);
  readonly #read = signal<TopView | null>(null);
  readonly #document: ShotDocument;
  readonly #follow: NewestWins<At, TopView>;
  readonly #followPaths: NewestWins<number, Paths>;

  readonly #stop: () => void;

  constructor(service: Service, document: ShotDocument, time: ReadonlySignal<number>, fail: Fail) {
    this.#document = document;
    const onError = (error: unknown): void => {
      fail(error, () => {
        document.refresh();
      });
    };
    this.#follow = new NewestWins({
      load: ({ time }, abort) => service.fromAbove.topView(document.view, time, abort),
      onResult: (view) => (this.#read.value = view),
      onBusy: (isBusy) => (this.reading.value = isBusy),
      onError,
      pause: frameDrawn,
      mostInFlight: 1,
    });
    this.#followPaths = new NewestWins({
      load: (_, abort) => service.fromAbove.paths(document.view, abort),
      onResult: (paths) => (this.paths.value = paths),
      onError,
      mostInFlight: 1,
    });
    this.#stop = this.#followAll(time);
  }

  /** The camera as last read, with the lens as it is by now. */
  readonly view: ReadonlySignal<TopView | null> = computed(() => {
    const [view, readout] = [this.#read.value, this.#document.readout.value];
    return view && readout ? withReadout(view, readout) : view;
  });

  /** Reads what is shown, whenever it changes. */
  #followAll(time: ReadonlySignal<number>): () => void {
    const { revision, dragging, hasLens } = this.#document;
    const stops = [
      effect(() => {
        const at = { time: time.value, revision: revision.value };
        if (this.isShown.value && hasLens) this.#follow.load(at);
      }),
      effect(() => {
        const now = revision.value;
        if (this.isShown.value && hasLens && !dragging.value) this.#followPaths.load(now);
      }),
    ];
    return () => {
      for (const stop of stops) stop();
    };
  }

  close(): void {
    this.#stop();
    this.#follow.clear();
    this.#followPaths.clear();
  }
}
