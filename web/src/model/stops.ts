/** Stops: f-numbers as they are engraved, in thirds, and the T-stops that go with them. */

/** F-numbers as engraved, in thirds of a stop from f/0.5 on. */
const ENGRAVED = [
  ...[0.5, 0.56, 0.63, 0.7, 0.8, 0.9, 1, 1.1, 1.2, 1.4, 1.6, 1.8, 2, 2.2, 2.5, 2.8, 3.2, 3.5, 4, 4.5, 5, 5.6, 6.3, 7.1],
  ...[8, 9, 10, 11, 13, 14, 16, 18, 20, 22, 25, 29, 32, 36, 40, 45, 51, 57, 64, 72, 80, 90],
];

/** What the stops on a lens are. */
export type Marking = "f" | "t";

/** The f-number that sets the size of the iris, and the T-stop, the f-number of a lens without losses that is as bright. */
export interface Stops {
  readonly f: number;
  readonly t: number;
}

/** Thirds of a stop from f/0.5 on, to the nearest one. */
function thirdsOf(stop: number): number {
  return Math.round(6 * Math.log2(stop / 0.5));
}

/** The nearest third of a stop, as engraved. */
export function nearestThird(stop: number): number {
  return ENGRAVED[thirdsOf(stop)] ?? Number(stop.toPrecision(2));
}

/** The engraved thirds from one stop to another, with the full stops among them. */
export function detents(least: number, most: number): readonly { readonly stop: number; readonly isFull: boolean }[] {
  return ENGRAVED.map((stop, third) => ({ stop, isFull: third % 3 === 0 })).filter(
    ({ stop }) => stop >= least && stop <= most,
  );
}

/** An f-number as engraved, to the next third: f/5.6. */
export function formatStop(fStop: number): string {
  return `f/${nearestThird(fStop).toString()}`;
}

/** The third of a stop that comes so many after a stop, or before it; null beyond what is engraved. */
export function nextThird(stop: number, count: number): number | null {
  const near = thirdsOf(stop);
  const off = (ENGRAVED[near] ?? stop) - stop;
  // From between two thirds, the first step is to the next one.
  const isPassed = Math.abs(off) > 1e-6 && Math.sign(off) === Math.sign(count);
  return ENGRAVED[near + count - (isPassed ? Math.sign(count) : 0)] ?? null;
}

/**
 * The stops that a number on the barrel stands for.
 *
 * @param number on the barrel: the f-number of the iris, or a T-stop, by which the light goes; the size of the iris goes by it either
 *     way.
 * @param transmittance of the glass, 0 to 1.
 */
export function stopsOf(number: number, marking: Marking, transmittance: number): Stops {
  return { f: number, t: marking === "t" ? number : number / Math.sqrt(transmittance) };
}

/** The number on the barrel at which a lens has a T-stop; null where no light comes through. */
export function numberOfT(tStop: number, marking: Marking, transmittance: number): number | null {
  if (marking === "t") return tStop;
  return transmittance > 0 ? Number((tStop * Math.sqrt(transmittance)).toPrecision(4)) : null;
}

/** A stop that is typed, as "2.8", "f/2.8" or "T 3"; null for what is none. */
export function parseStop(text: string): { readonly stop: number; readonly letter: Marking | null } | null {
  const [, letter = "", digits = ""] = /^\s*([ft]?)\s*\/?\s*([\d.,]+)\s*$/i.exec(text) ?? [];
  const stop = Number(digits.replace(",", ".") || NaN);
  if (!(stop > 0) || !Number.isFinite(stop)) return null;
  return { stop, letter: letter === "" ? null : letter.toLowerCase() === "t" ? "t" : "f" };
}

/** A stop with its letter, as on the barrel: f/2.8, T 3. */
export function sayStop(stop: number, letter: Marking): string {
  if (stop === 0) return "pinhole";
  const digits = Number.isFinite(stop) ? Number(stop.toFixed(2)).toString() : "∞";
  return letter === "t" ? `T ${digits}` : `f/${digits}`;
}

/** The stop by which the light goes, with its letter: a T-stop where the barrel has those or the glass takes light. */
export function statedStop(number: number, marking: Marking, transmittance: number): string {
  const letter = marking === "t" || transmittance < 1 ? "t" : "f";
  return sayStop(number === 0 ? 0 : stopsOf(number, marking, transmittance)[letter], letter);
}
