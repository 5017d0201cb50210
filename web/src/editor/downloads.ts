/** Files that are made of an open shot. */

import type { ReadonlySignal } from "@preact/signals";
import { restQuality } from "../model/quality";
import type { CurveFormat, Download, PictureFormat, Service } from "../net/service";
import type { ShotDocument } from "./document";
import type { Playhead } from "./playhead";

/** Width of a downloaded frame. */
const WIDTH_PX = 1920;

/** What files are made of. */
interface Source {
  readonly document: Pick<ShotDocument, "view">;
  readonly playhead: Pick<Playhead, "time">;
  /** Moments of the shutter interval in pictures at rest. */
  readonly motion: ReadonlySignal<number>;
  /** Width over height of the picture. */
  readonly aspect: number;
}

export class Downloads {
  readonly #service: Service;
  readonly #source: Source;

  constructor(service: Service, source: Source) {
    [this.#service, this.#source] = [service, source];
  }

  curve(format: CurveFormat, abort?: AbortSignal): Promise<Download> {
    return this.#service.downloadCurve(this.#source.document.view, format, abort);
  }

  edits(abort?: AbortSignal): Promise<Download> {
    return this.#service.downloadEdits(this.#source.document.view.shot, abort);
  }

  /** The frame at this time in full HD. */
  frame(format: PictureFormat, abort?: AbortSignal): Promise<Download> {
    const { document, playhead, motion, aspect } = this.#source;
    // A file may take its time: the scene is drawn at each moment.
    const quality = { ...restQuality(WIDTH_PX, WIDTH_PX / aspect, motion.value), motionBy: "moments" as const };
    return this.#service.downloadFrame(document.view, playhead.time.value, quality, format, abort);
  }
}
