/**
 * The focus ring of a lens. Its *turn* goes from 0 at the close focus to 1 at infinity, in proportion to the inverse of the distance,
 * as a helicoid moves a lens. The scale is one for each lens, whatever it is focused on.
 */

import { barrelMarks, inverse, type LengthUnit } from "./distance";
import type { Readout } from "./shot";

/** Where distances count from. The service's are from the entrance pupil; makers engrave those from the film. */
export const ORIGINS = ["film", "pupil"] as const;
export type Origin = (typeof ORIGINS)[number];

export interface Ring {
  /** The nearest focus, m from the entrance pupil. */
  readonly closeM: number;
  /** From the entrance pupil to the film, m, focused at infinity and at the close focus. */
  readonly toFilmM: readonly [number, number];
}

/** The ring of the lens of a readout; null where that has none that can be turned. */
export function ringOf({ closeFocusM, pupilToFilmMm }: Readout): Ring | null {
  if (!(closeFocusM > 0 && closeFocusM < 1e6)) return null;
  return { closeM: closeFocusM, toFilmM: [pupilToFilmMm[0] / 1000, pupilToFilmMm[1] / 1000] };
}

/** The turn at which a distance from the entrance pupil is in focus, within what the ring reaches. */
export function turnAt({ closeM }: Ring, distanceM: number): number {
  return held(1 - closeM * inverse(distanceM));
}

/** The distance from the entrance pupil that a turn focuses on, m. */
export function distanceAt({ closeM }: Ring, turn: number): number {
  return turn >= 1 ? Infinity : closeM / (1 - held(turn));
}

export function held(turn: number): number {
  return Math.min(Math.max(turn, 0), 1);
}

/** A distance from the entrance pupil as it is from an origin. */
export function saidFrom(origin: Origin, { closeM, toFilmM: [infinity, close] }: Ring, distanceM: number): number {
  if (origin === "pupil" || distanceM === Infinity) return distanceM;
  return distanceM + infinity + ((close - infinity) * closeM) / distanceM;
}

/** A distance from an origin as it is from the entrance pupil; NaN where nothing is in focus so near to the film. */
export function fromPupil(origin: Origin, { closeM, toFilmM: [infinity, close] }: Ring, saidM: number): number {
  if (origin === "pupil" || saidM === Infinity) return saidM;
  const before = saidM - infinity;
  return (before + Math.sqrt(before * before - 4 * (close - infinity) * closeM)) / 2;
}

export interface Engraving {
  readonly turn: number;
  /** As engraved, m from the origin. */
  readonly distanceM: number;
  /** Whether its number is engraved, too. */
  readonly isNamed: boolean;
}

/** Numbers on the ring, and lines between them. */
const [MOST_NAMED, MOST_LINES] = [28, 110];

/** The scale of a ring, from close focus to infinity. */
export function engravings(ring: Ring, unit: LengthUnit, origin: Origin): Engraving[] {
  const turnOf = (saidM: number): number => 1 - ring.closeM * inverse(fromPupil(origin, ring, saidM));
  const marks = (most: number): number[] => {
    const near = 1 / ring.closeM;
    return barrelMarks(near * (1 + 1e-9), 0, unit, most, (saidM) => inverse(fromPupil(origin, ring, saidM)));
  };
  const named = new Set(marks(MOST_NAMED));
  return [...new Set([...named, ...marks(MOST_LINES)])]
    .map((distanceM) => ({ turn: turnOf(distanceM), distanceM, isNamed: named.has(distanceM) }))
    .toSorted((a, b) => a.turn - b.turn);
}

/** Turn within which a mark draws the ring. */
export const REACH = 0.012;

/** A turn drawn towards the nearest mark within reach: slowly near to it, so that the hand feels it, and without a jump. */
export function drawnTo(marks: readonly number[], turn: number, reach = REACH): number {
  const mark = marks.reduce<number | null>(
    (best, at) => (best === null || Math.abs(at - turn) < Math.abs(best - turn) ? at : best),
    null,
  );
  if (mark === null || Math.abs(turn - mark) >= reach) return turn;
  const off = (turn - mark) / reach;
  return mark + reach * off * off * off;
}
