/** Drags of the selected keys, and what labels of edits call them. */

import type { KeyStack, OwnedKey } from "../model/key_lanes";
import { formatFrame } from "../model/time";

/** How far a pointer or a key has moved stacks. */
export interface KeyShift {
  /** Time codes. */
  readonly by: number;
  /** How near something must be to be snapped to, time codes; null does not snap, not even to frames. */
  readonly reach: number | null;
  /** What else becomes of each of their keys: another value, or other handles. */
  readonly reshape?: (owned: OwnedKey) => OwnedKey;
}

/** A drag of the selected stacks: it is seen in the picture, and its end is an edit. */
export interface KeyDrag {
  move(shift: KeyShift): void;
  /** Resolves to the time of the stack that was grabbed, once the service has it there; to null where it has not. */
  commit(shift: KeyShift): Promise<number | null>;
  cancel(): void;
}

/** Stacks as labels of edits call them. */
export function named(stacks: readonly KeyStack[]): string {
  const [only] = stacks;
  if (only && stacks.length === 1) return `the key at ${formatFrame(only.time)}`;
  return `${stacks.length.toString()} keys`;
}

export function idsOf(stacks: readonly KeyStack[]): string[] {
  return stacks.map(({ id }) => id);
}

/** The selected stacks as the edits under way leave them. */
export interface Pending {
  /** For each of them the ids by which the service may have it, as the edits under way are made one after the other. */
  readonly of: readonly ReadonlySet<string>[];
  readonly stacks: readonly KeyStack[];
}
