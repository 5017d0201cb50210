/** Steps from a key to the next one of its lane, by the keyboard. */

import type { Session } from "../../editor/session";
import { stackId, type KeyLane, type KeyStack } from "../../model/key_lanes";

/** Goes to the key before or after in the lane by `,` or `.`. */
export function goToNext({ keys, playhead }: Session, lane: KeyLane, stack: KeyStack, event: KeyboardEvent): boolean {
  if (event.key !== "," && event.key !== ".") return false;
  const next = lane.stacks[lane.stacks.indexOf(stack) + (event.key === "." ? 1 : -1)];
  if (next) {
    keys.select([next]);
    playhead.goTo(next.time);
    const list = (event.currentTarget as HTMLElement).closest(".lanes");
    if (focusOn(list, next.id)) return true;
    // It was beyond what the timeline shows.
    requestAnimationFrame(() => {
      focusOn(list, next.id);
    });
  }
  return true;
}

/** Focuses a key; returns whether it could be. */
function focusOn(lanes: Element | null, stack: string): boolean {
  const key = lanes?.querySelector<HTMLElement>(`[data-stack="${CSS.escape(stack)}"]`);
  key?.focus();
  return key !== undefined && key === document.activeElement;
}

/** Focuses a key of a lane where it has been moved to, unless something else has been taken up meanwhile. */
export function focusMoved(moved: Element | null, lane: KeyLane, time: number): void {
  const isOnKey = document.activeElement?.matches("[data-stack]") ?? false;
  if (isOnKey || document.activeElement === document.body)
    focusOn(moved?.closest(".lanes") ?? null, stackId(lane.id, time));
}
