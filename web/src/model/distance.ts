/**
 * Distances along the view axis, in metres; `Infinity` is a distance like any other.
 *
 * On screen they are metres or feet and inches, as the person chose, and what is typed in either is understood.
 */

export type LengthUnit = "m" | "ft";

const METRES_PER_INCH = 0.0254;
export const METRES_PER_FOOT = 0.3048;

/** Inverse depth in 1/m: what focus is linear in. Infinity has 0. */
export function inverse(distanceM: number): number {
  return distanceM === Infinity ? 0 : 1 / distanceM;
}

/** A distance as a focus puller reads it: about three digits, `∞` for infinity. */
export function formatDistance(distanceM: number, unit: LengthUnit): string {
  if (Number.isNaN(distanceM)) return "–";
  if (!Number.isFinite(distanceM)) return "∞";
  return unit === "m" ? `${metreDigits(distanceM)} m` : feetAndInches(distanceM);
}

function metreDigits(distanceM: number): string {
  const size = Math.abs(distanceM);
  return distanceM.toFixed(size < 1 ? 3 : size < 10 ? 2 : size < 100 ? 1 : 0);
}

function feetAndInches(distanceM: number): string {
  const sign = distanceM < 0 ? "−" : "";
  const inches = Math.abs(distanceM) / METRES_PER_INCH;
  if (inches >= 12 * 100) return `${sign}${Math.round(inches / 12)}′`;
  const places = inches < 36 ? 1 : 0;
  const whole = Number(inches.toFixed(places));
  const feet = Math.floor(whole / 12 + 1e-9);
  const rest = Number((whole - feet * 12).toFixed(places));
  return feet > 0 ? `${sign}${feet}′ ${rest}″` : `${sign}${rest}″`;
}

/** A round distance, as engraved on a lens: no digits that say nothing. */
export function formatMark(distanceM: number, unit: LengthUnit): string {
  if (!Number.isFinite(distanceM)) return "∞";
  return unit === "m" ? Number(distanceM.toPrecision(3)).toString() : feetAndInches(distanceM).replace(/ 0″$/, "");
}

/**
 * A typed distance in metres: `2.5`, `2.5 m`, `85 cm`, `10'`, `10' 6"`, `10ft`, `∞` or `inf`.
 *
 * @param unit of a number that names none.
 * @returns `null` for what is no distance above 0.
 */
export function parseDistance(text: string, unit: LengthUnit): number | null {
  const typed = text.trim().toLowerCase().replace(/[′’]/g, "'").replace(/[″”]/g, '"').replace(",", ".");
  if (/^(∞|inf|infinity)$/.test(typed)) return Infinity;
  const imperial = /^(?:(\d*\.?\d+)\s*(?:'|ft))?\s*(?:(\d*\.?\d+)\s*(?:"|in))?$/.exec(typed);
  if (imperial && (imperial[1] ?? imperial[2]) !== undefined) {
    return positive(Number(imperial[1] ?? 0) * METRES_PER_FOOT + Number(imperial[2] ?? 0) * METRES_PER_INCH);
  }
  const metric = /^(\d*\.?\d+)\s*(mm|cm|m)?$/.exec(typed);
  if (!metric) return null;
  const scale = { mm: 0.001, cm: 0.01, m: 1, none: unit === "m" ? 1 : METRES_PER_FOOT };
  return positive(Number(metric[1]) * scale[(metric[2] ?? "none") as keyof typeof scale]);
}

function positive(value: number): number | null {
  return Number.isFinite(value) && value > 0 ? value : null;
}

/** A span of inverse depth with marks to label it by. */
export interface DistanceAxis {
  /** Inverse depth at the bottom, 1/m: the nearest. */
  readonly nearW: number;
  /** Inverse depth at the top, 1/m: the farthest; may lie a little beyond infinity, below 0. */
  readonly farW: number;
  /** Distances to label, in metres, near to far. */
  readonly ticks: readonly number[];
}

/**
 * A reciprocal axis that holds the given distances with some air around them.
 *
 * Reciprocal, because focus is linear in it: depth of field is a band of even height wherever the lens is focused, and
 * a rack between two marks is a straight line, as on the barrel of a lens.
 */
export function distanceAxis(distancesM: readonly number[], unit: LengthUnit, mostTicks = 6): DistanceAxis {
  const ws = distancesM.filter((d) => d > 0).map(inverse);
  let near = ws.length > 0 ? Math.max(...ws) : 1;
  let far = ws.length > 0 ? Math.min(...ws) : 0;
  // A curve that hardly moves still gets a window that is wide enough to see that it hardly moves.
  const least = Math.max(0.3 * near, 1e-4);
  if (near - far < least) [near, far] = [near + least / 2, Math.max(0, far - least / 2)];
  const air = 0.08 * (near - far);
  const axis = { nearW: near + air, farW: far < 2 * air ? -air : far - air };
  return { ...axis, ticks: barrelMarks(axis.nearW, axis.farW, unit, mostTicks) };
}

/** Where a distance stands on an axis: 0 at its near end, 1 at its far end. */
export function axisFraction(axis: DistanceAxis, distanceM: number): number {
  return (axis.nearW - inverse(distanceM)) / (axis.nearW - axis.farW);
}

/**
 * Round distances, as engraved on a lens, that do not crowd each other on a reciprocal axis.
 *
 * @param placeOf gives the inverse depth at which a distance stands, where it counts from elsewhere; NaN for none.
 */
export function barrelMarks(
  nearW: number,
  farW: number,
  unit: LengthUnit,
  most: number,
  placeOf: (distanceM: number) => number = inverse,
): number[] {
  const scale = unit === "m" ? 1 : METRES_PER_FOOT;
  const gap = (nearW - farW) / (most + 1);
  const marks: number[] = farW <= 0 ? [Infinity] : [];
  let last = farW <= 0 ? 0 : -Infinity;
  for (const candidate of ROUND.map((r) => r * scale).reverse()) {
    const w = placeOf(candidate);
    if (!(w >= farW && w <= nearW && w - last >= gap)) continue;
    marks.push(candidate);
    last = w;
  }
  return marks.reverse();
}

const ROUND = [-2, -1, 0, 1, 2, 3].flatMap((power) =>
  [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9].map((m) => m * 10 ** power),
);
