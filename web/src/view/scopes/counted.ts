/** The picture on screen, counted for its scopes as it changes. */

import { computed, effect } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";
import type { Displayed } from "../../editor/pictures";
import type { Session } from "../../editor/session";
import { figuresOf, planesOf, type Figures, type Planes } from "../../model/scopes";
import { frameDrawn } from "../../net/frame_drawn";

/** A picture in counts. */
export interface Counted {
  readonly planes: Planes;
  readonly width: number;
  readonly figures: Figures;
  readonly of: Pick<Displayed, "time" | "revision" | "stage">;
}

/** Counts each picture once it is on screen, at most one in a frame of the browser; null until there is one. */
export function useCounted({ pictures }: Session): Counted | null {
  const [counted, setCounted] = useState<Counted | null>(null);
  useEffect(() => {
    const reader = document.createElement("canvas");
    const bitmap = computed(() => pictures.displayed.value?.bitmap ?? null);
    let [isDue, isOver] = [false, false];
    const count = (): void => {
      isDue = false;
      const shown = pictures.displayed.peek();
      if (shown && !isOver) setCounted(countedOf(shown, reader));
    };
    const stop = effect(() => {
      if (bitmap.value === null || isDue) return;
      isDue = true;
      void frameDrawn().then(count);
    });
    return () => {
      isOver = true;
      stop();
    };
  }, [pictures]);
  return counted;
}

/** Reads the pixels of a picture as they came, whatever size it is shown at. */
function countedOf({ bitmap, time, revision, stage }: Displayed, reader: HTMLCanvasElement): Counted | null {
  const { width, height } = bitmap;
  [reader.width, reader.height] = [width, height];
  const context = reader.getContext("2d", { alpha: false, willReadFrequently: true });
  if (!context) return null;
  context.drawImage(bitmap, 0, 0);
  const planes = planesOf(context.getImageData(0, 0, width, height).data);
  return { planes, width, figures: figuresOf(planes), of: { time, revision, stage } };
}
