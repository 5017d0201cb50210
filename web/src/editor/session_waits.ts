/** The waits of an open shot: what its parts do, in words, and how that is stopped. */

import { computed, type ReadonlySignal } from "@preact/signals";
import { formatFrame } from "../model/time";
import type { CacheFiller } from "./cache_filler";
import type { ShotDocument } from "./document";
import type { CameraPhotography } from "./photography";
import type { Picks } from "./picks";
import type { Pictures } from "./pictures";
import type { Waits } from "./waits";

/** What is waited for. */
interface Parts {
  readonly document: Pick<ShotDocument, "saving" | "reading" | "solved">;
  readonly pictures: Pick<Pictures, "drawing" | "displayed" | "stop">;
  readonly photography: Pick<CameraPhotography, "reading" | "metering" | "stopMeter">;
  readonly filler: Pick<CacheFiller, "asked" | "progress" | "ask">;
  readonly picks: Pick<Picks, "picking" | "stop">;
}

/** Follows what an open shot waits for; returns what ends that. */
export function followWaits(waits: Waits, { document, pictures, photography, filler, picks }: Parts): () => void {
  const drawing = computed(() => {
    const frame = pictures.drawing.value;
    return frame === null ? null : `Drawing frame ${formatFrame(frame)}`;
  });
  const drawn = computed(() => {
    const shown = pictures.displayed.value;
    return shown?.stage === "refining" ? shown.share : null;
  });
  const saving = computed(() => {
    const label = document.saving.value;
    return label === null ? null : `Saving: ${label}`;
  });
  const cached = computed(() => filler.progress.value.cached / Math.max(1, filler.progress.value.of));
  const stops = [
    waits.follow("picture", drawing, {
      progress: drawn,
      stop: () => {
        pictures.stop();
      },
    }),
    waits.follow("meter", named("Metering", photography.metering), {
      stop: () => {
        photography.stopMeter();
      },
    }),
    waits.follow("curve", named("Solving the focus curve", document.solved.solving), {
      stop: () => {
        document.solved.stop();
      },
    }),
    waits.follow("frames", named("Caching frames", filler.asked), {
      progress: cached,
      stop: () => {
        filler.ask(false);
      },
    }),
    waits.follow("pick", named("Finding what is there", picks.picking), {
      stop: () => {
        picks.stop();
      },
    }),
    waits.follow("lens", named("Reading the lens", document.reading)),
    waits.follow("camera", named("Reading the camera", photography.reading)),
    // A change that is sent may be made by the time that it is stopped: undo takes it back, and nothing else does.
    waits.follow("edit", saving),
  ];
  return () => {
    for (const stop of stops) stop();
  };
}

/** A name while something is there or true. */
function named(name: string, when: ReadonlySignal<unknown>): ReadonlySignal<string | null> {
  return computed(() => (when.value === null || when.value === false ? null : name));
}
