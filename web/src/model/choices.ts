/** What a shot leaves open: variants of its variant sets, and payloads. */

import type { Change } from "./changes";
import { primName } from "./shot";

export interface VariantSet {
  readonly prim: string;
  readonly name: string;
  readonly variants: readonly string[];
  /** The variant that is chosen; empty for none. */
  readonly selection: string;
  /** Whether an edit of the shot chooses it. */
  readonly edited: boolean;
}

export interface Payload {
  readonly prim: string;
  readonly shown: boolean;
  readonly edited: boolean;
}

export interface Choices {
  readonly variantSets: readonly VariantSet[];
  readonly payloads: readonly Payload[];
  /** Whether all of them are listed. */
  readonly complete: boolean;
}

/** An edit of the choices, with its name in the history. */
export interface ChoiceEdit {
  readonly label: string;
  readonly change: Change;
}

/** Chooses a variant, empty for none; null takes the edit back. */
export function chooseVariant({ prim, name }: VariantSet, variant: string | null): ChoiceEdit {
  const to = variant === null ? "as in the shot" : variant || "none";
  return {
    label: `${primName(prim)}: ${name} ${to}`,
    change: { type: "chooseVariant", prim, variantSet: name, variant },
  };
}

/** Shows a prim with its payload, or leaves it out; null takes the edit back. */
export function showPayload({ prim }: Payload, shown: boolean | null): ChoiceEdit {
  const words = shown === null ? "as in the shot" : shown ? "shown" : "left out";
  return { label: `${primName(prim)}: ${words}`, change: { type: "showPayload", prim, shown } };
}

/** Whether a change may bring or take cameras. */
export function mayChangeCameras({ type }: Change): boolean {
  return type === "chooseVariant" || type === "showPayload";
}
