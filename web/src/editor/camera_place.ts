/** Where the shot's camera has keys of its place, followed from edit to edit. */

import { computed, effect, signal, type ReadonlySignal } from "@preact/signals";
import { mayPlaceCamera, type CameraPlace } from "../model/camera_place";
import type { Key } from "../model/keys";
import { sameTime } from "../model/time";
import { NewestWins } from "../net/newest";
import type { Service } from "../net/service";
import type { ShotDocument } from "./document";
import type { Fail } from "./fail";

const NO_KEYS: readonly Key[] = [];

export class CameraPlaceReader {
  readonly #read = signal<{ readonly revision: number; readonly place: CameraPlace } | null>(null);
  readonly #document: ShotDocument;
  readonly #time: ReadonlySignal<number>;
  readonly #follow: NewestWins<number, CameraPlace>;
  readonly #stop: () => void;

  constructor(service: Service, document: ShotDocument, time: ReadonlySignal<number>, fail: Fail) {
    [this.#document, this.#time] = [document, time];
    this.#follow = new NewestWins({
      load: (_, abort) => service.fromAbove.cameraPlace(document.view, time.peek(), abort),
      onResult: (place, revision) => (this.#read.value = { revision, place }),
      onError: (error) => {
        fail(error, () => {
          document.refresh();
        });
      },
      mostInFlight: 1,
    });
    const { revision, dragging, hasLens } = document;
    this.#stop = effect(() => {
      const now = revision.value;
      if (!hasLens || dragging.value) return;
      const read = this.#read.peek();
      const isAsBefore = read?.revision === now - 1 && document.changesOf(now)?.some(mayPlaceCamera) === false;
      if (isAsBefore) this.#read.value = { ...read, revision: now };
      else this.#follow.load(now);
    });
  }

  /** The keys of its place, in order of time. */
  readonly keys = computed(() => this.#read.value?.place.keys ?? NO_KEYS);

  /** Whether `keys` are of the present revision. */
  readonly fresh = computed(
    () => !this.#document.hasLens || this.#read.value?.revision === this.#document.revision.value,
  );

  /** The key where the playhead is. */
  readonly here = computed(() => this.keys.value.find(({ time }) => sameTime(time, this.#time.value)) ?? null);

  /** Why it cannot be taken back to the place that the shot itself has; null where it can. */
  readonly noWayBack = computed(() => {
    const { isEdited = false, isInShot = true } = this.#read.value?.place ?? {};
    if (!isInShot) return "The camera is of the edits: the shot has no place for it.";
    return isEdited ? null : "The camera is where the shot has it.";
  });

  close(): void {
    this.#stop();
    this.#follow.clear();
  }
}
