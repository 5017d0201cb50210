/** Lenses that can be put on a camera. */

import type { Readout } from "./shot";

export interface LensSummary {
  /** In addresses and edits. */
  readonly name: string;
  /** Engraving: name, focal length and f-number. */
  readonly title: string;
  readonly model: string;
  readonly focalLengthMm: number;
  /** Shortest and longest of a zoom; null for a lens of one focal length. */
  readonly focalLengthRangeMm: readonly [number, number] | null;
  /** Wide open. */
  readonly fStop: number;
  /** One line. */
  readonly description: string;
  /** Its maker, families and year: a search finds it by them. */
  readonly keywords: string;
  /** Address of a small picture of it. */
  readonly section: string;
  /** Address of a sheet about it. */
  readonly sheet: string;
}

/** The lens on the camera: of the library, the thin lens, or one of the shot or of a file. */
export type MountedLens =
  | { readonly kind: "library"; readonly lens: LensSummary }
  | { readonly kind: "thin" }
  | { readonly kind: "other"; readonly title: string };

export function mountedLens(readout: Readout, lenses: readonly LensSummary[]): MountedLens {
  const lens = lenses.find(({ title, model }) => title === readout.lensName && model === readout.lensModel);
  if (lens) return { kind: "library", lens };
  if (readout.lensModel === "thin" && readout.lensName === "") return { kind: "thin" };
  return { kind: "other", title: readout.lensName || `A ${readout.lensModel} lens` };
}

/** What a lens of the library is, in a line or two. */
export function describedLens({ description, focalLengthRangeMm }: LensSummary): string {
  if (focalLengthRangeMm === null) return description;
  const [shortest, longest] = focalLengthRangeMm;
  return `Zooms from ${trimmed(shortest, 1)} to ${trimmed(longest, 1)} mm. ${description}`;
}

/** The lenses in groups, as a list shows them: of glass, and by a model. */
export function grouped(lenses: readonly LensSummary[]): readonly (readonly [string, readonly LensSummary[]])[] {
  const isGlass = ({ model }: LensSummary): boolean => ["prescription", "spherical", "heightField"].includes(model);
  return [
    ["Real glass", lenses.filter(isGlass)],
    ["Ideal and effects", lenses.filter((lens) => !isGlass(lens))],
  ];
}

/** The lens on the camera and its stop, in words: "Zeiss Planar 50/1.4 at f/2". */
export function saidOf({ lensName, lensModel, focalLengthMm, fStop }: Readout): string {
  if (fStop === 0) return "a pinhole";
  const isThin = lensModel === "thin" && lensName === "";
  const lens = isThin ? `a thin ${trimmed(focalLengthMm, 1)} mm lens` : lensName || `a ${lensModel} lens`;
  return `${lens} at f/${trimmed(fStop, 2)}`;
}

function trimmed(value: number, decimals: number): string {
  return Number(value.toFixed(decimals)).toString();
}
