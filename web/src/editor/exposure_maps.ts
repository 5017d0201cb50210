/** Reads the exposure of each pixel of the present picture, once its best one is there. */

import { effect, signal } from "@preact/signals";
import type { ExposureMap } from "../model/exposure_map";
import { decodeExposureMap } from "../net/exposure_map";
import { NewestWins } from "../net/newest";
import type { Service } from "../net/service";
import type { ShotDocument } from "./document";
import type { Fail } from "./fail";

/** Width of a map: enough to see which things are how bright, and little work. */
const WIDTH_PX = 480;

/** The session that is read in. */
interface Exposed {
  readonly document: ShotDocument;
  readonly playhead: { readonly time: { readonly value: number } };
  readonly settled: { readonly value: boolean };
  readonly aspect: number;
}

export class ExposureMaps {
  /** Whether maps are wanted. */
  readonly isWanted = signal(false);
  /** The map of the present picture; null while there is none. */
  readonly present = signal<ExposureMap | null>(null);
  readonly #stop: () => void;

  constructor(service: Service, session: Exposed, fail: Fail) {
    const { document } = session;
    const reader = new NewestWins<{ time: number; revision: number }, ExposureMap>({
      load: async ({ time }, signal) => {
        const size = { width: WIDTH_PX, height: Math.max(1, Math.round(WIDTH_PX / session.aspect)) };
        return decodeExposureMap(await service.exposureMap(document.view, time, size, signal));
      },
      onResult: (map, { revision }) => {
        if (revision === document.revision.peek()) this.present.value = map;
      },
      onError: (error) => {
        fail(error, () => {
          document.refresh();
        });
      },
      mostInFlight: 1,
    });
    const unfollow = effect(() => {
      const [time, revision] = [session.playhead.time.value, document.revision.value];
      this.present.value = null;
      if (this.isWanted.value && session.settled.value) reader.load({ time, revision });
      else reader.clear();
    });
    this.#stop = () => {
      unfollow();
      reader.clear();
    };
  }

  close(): void {
    this.#stop();
  }
}
