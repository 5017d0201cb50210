/** Comparison of the picture on screen, A, with another one, B. */

import type { LensSummary } from "./lens";
import type { Changes } from "./changes";
import { primName } from "./shot";
import { formatStop } from "./stops";

/** How the two are shown: A alone, B alone, beside a divider, their difference, or one after the other. */
export const COMPARISONS = ["off", "other", "wipe", "difference", "flicker"] as const;
export type Comparing = (typeof COMPARISONS)[number];

/** Factors of the difference; each is a power of two. */
export const GAINS = ["1", "4", "16"] as const;
export type Gain = (typeof GAINS)[number];

/** The thin lens among the names of lenses. */
export const THIN = "";

/** The camera as it would be otherwise. Null leaves what there is. */
export interface Otherwise {
  /** Prim path. */
  readonly camera: string | null;
  /** Name in the lens library, or `THIN`. */
  readonly lens: string | null;
  readonly fStop: number | null;
}

/** Changes that make the camera so, at a time. Where focus points set the stop, they do so no longer. */
export function changesOf({ lens, fStop }: Otherwise, time: number, pointsSetStop: boolean): Changes {
  return [
    ...(lens === null ? [] : [{ type: "setCamera", values: { lens: lens === THIN ? null : lens } } as const]),
    ...(fStop !== null && pointsSetStop ? [{ type: "setFocus", values: { solveStop: false } } as const] : []),
    ...(fStop === null ? [] : [{ type: "setCamera", values: { fStop, time } } as const]),
  ];
}

/** What is otherwise, in words. */
export function saidOtherwise({ camera, lens, fStop }: Otherwise, lenses: readonly LensSummary[]): string {
  const said = [
    camera === null ? "" : primName(camera),
    lens === null ? "" : lens === THIN ? "thin lens" : (lenses.find(({ name }) => name === lens)?.title ?? lens),
    fStop === null ? "" : formatStop(fStop),
  ].filter(Boolean);
  return said.length > 0 ? said.join(", ") : "the same";
}
