/** Lenses that can be put on a camera. */

import type { Readout } from "./shot";

export interface LensSummary {
  /** In addresses and edits. */
  readonly name: string;
  /** What is engraved on it: its name, focal length and f-number. */
  readonly title: string;
  readonly model: string;
  readonly focalLengthMm: number;
  /** Wide open. */
  readonly fStop: number;
  /** One line. */
  readonly description: string;
  /** Address of a small picture of it. */
  readonly section: string;
  /** Address of a sheet about it. */
  readonly sheet: string;
}

/** What stands on the camera: a lens of the library, the thin lens, or another that the shot or a file brought. */
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

/** The lenses as a list shows them: those that are made of glass, and those that have errors of a kind. */
export function grouped(lenses: readonly LensSummary[]): readonly (readonly [string, readonly LensSummary[]])[] {
  const isGlass = ({ model }: LensSummary): boolean => ["prescription", "spherical", "heightField"].includes(model);
  return [
    ["Real glass", lenses.filter(isGlass)],
    ["Ideal and effects", lenses.filter((lens) => !isGlass(lens))],
  ];
}
