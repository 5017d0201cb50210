/** Drags of the selected keys, and what labels of edits call them. */

import { holdAll, mapKeys, movedStack, snapShift, type KeyStack, type OwnedKey } from "../model/key_lanes";
import { formatFrame, type FrameRange } from "../model/time";

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

/**
 * Returns a function that tells how far stacks go together, time codes.
 *
 * @param from time of the one that snaps.
 * @param targets times to snap to.
 */
export function snapping(
  range: FrameRange,
  stacks: readonly KeyStack[],
  from: number,
  targets: readonly number[],
): (shift: KeyShift) => number {
  return ({ by, reach }) => {
    const shift = reach === null ? Number(by.toFixed(2)) : snapShift(range, from, by, targets, reach);
    return holdAll(range, stacks, shift);
  };
}

/** Stacks that have gone so far, and are otherwise what becomes of them. */
export function shifted(
  stacks: readonly KeyStack[],
  { reshape }: Pick<KeyShift, "reshape">,
  by: number,
): readonly KeyStack[] {
  const reshaped = reshape ? mapKeys(stacks, reshape) : stacks;
  return by === 0 ? reshaped : reshaped.map((stack) => movedStack(stack, by));
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
  /** Whether the newest of these edits has been made; undefined where none is under way. */
  readonly isMade?: Promise<boolean>;
}
