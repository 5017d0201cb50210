/** Axes and triggers of game controllers, as a turn of the ring or as the speed of one. */

export const WAYS = ["absolute", "rate"] as const;
/** Whether an axis is where the ring is to be, or how fast it turns. */
export type Way = (typeof WAYS)[number];

/** What of a game controller turns the ring. */
export interface Lever {
  readonly kind: "axis" | "button";
  readonly index: number;
}

/** A game controller, as the browser has it. */
export interface Pad {
  /** -1 to 1. */
  readonly axes: readonly number[];
  readonly buttons: readonly { readonly value: number }[];
}

/** Share of the way of a stick about its middle that counts as rest. */
const REST = 0.12;
/** Change of a lever that tells that it is the one, when one is to be learned. */
const LEARNED = 0.5;

/** Where a lever is: -1 to 1 of an axis, 0 to 1 of a trigger; null where the pad has none such. */
export function leverAt(pad: Pad, { kind, index }: Lever): number | null {
  return (kind === "axis" ? pad.axes[index] : pad.buttons[index]?.value) ?? null;
}

/** The turn, 0 to 1, that a lever stands for. */
export function turnOf(lever: Lever, at: number): number {
  const turn = lever.kind === "axis" ? (at + 1) / 2 : at;
  return Math.min(Math.max(turn, 0), 1);
}

/** Share of the greatest speed at which a lever turns the ring, -1 to 1: 0 at rest, and fine near to it. */
export function rateOf(at: number): number {
  const beyond = Math.max(Math.abs(at) - REST, 0) / (1 - REST);
  return Math.sign(at) * Math.min(beyond * beyond, 1);
}

/** The lever that has moved since a pad was looked at first; null where none has. */
export function movedLever(before: Pad, now: Pad): Lever | null {
  const axis = now.axes.findIndex((at, index) => Math.abs(at - (before.axes[index] ?? 0)) > LEARNED);
  if (axis >= 0) return { kind: "axis", index: axis };
  const button = now.buttons.findIndex(({ value }, index) => value - (before.buttons[index]?.value ?? 0) > LEARNED);
  return button >= 0 ? { kind: "button", index: button } : null;
}
