/** Gestures on a key that is shown somewhere: drags by a pointer, and moves by the arrow keys for as long as one is down. */

import { useEffect, useRef } from "preact/hooks";
import type { KeyDrag, KeyShift } from "../../editor/key_drag";
import type { Session } from "../../editor/session";
import type { KeyStack } from "../../model/key_lanes";
import { followPointer } from "../hooks";

/** How far a pointer goes before it drags, and how near something must be to be snapped to. */
const SLACK_PX = 3;
export const SNAP_PX = 6;

/** How far a pointer has gone, px, or the arrow keys, frames and steps of the value. */
export interface Way {
  readonly right: number;
  readonly down: number;
  /** Without snapping. */
  readonly isFree: boolean;
  /** Along the longer of both ways alone. */
  readonly isStraight: boolean;
}

interface GestureOptions {
  /** What is moved, with the other selected keys. */
  readonly stack: KeyStack;
  /** What a drag of a pointer makes of the selected keys. */
  readonly dragged: (way: Way) => KeyShift;
  /** What the arrow keys make of them. */
  readonly nudged: (way: Way) => KeyShift;
  /** Whether it goes up and down, too. */
  readonly isRaised: boolean;
  /** A press of the pointer without a drag; with Shift it adds to the selection. */
  readonly click: (adds: boolean) => void;
  /** Called once the service has the keys where they have been moved. */
  readonly arrived: (time: number) => void;
}

export interface KeyGestures {
  readonly onPointerDown: (down: PointerEvent) => void;
  /** Returns whether the key was for it. */
  readonly onKeyDown: (event: KeyboardEvent) => boolean;
  readonly onKeyUp: (event: KeyboardEvent) => void;
  readonly onBlur: () => void;
}

const ACROSS: ReadonlySet<string> = new Set(["ArrowLeft", "ArrowRight"]);
const UP_AND_DOWN: ReadonlySet<string> = new Set(["ArrowUp", "ArrowDown"]);

/** An arrow key that is down: what it moves, and how far it has. */
interface HeldKey {
  readonly drag: KeyDrag;
  readonly way: Way;
  readonly shift: (way: Way) => KeyShift;
}

/** The handlers of an element that stands for a key. */
export function useKeyGestures(session: Session, options: GestureOptions): KeyGestures {
  const held = useRef<HeldKey | null>(null);
  const giveUp = useRef<(() => void) | null>(null);
  useEffect(
    () => () => {
      giveUp.current?.();
      held.current?.drag.cancel();
    },
    [],
  );
  const letGo = async (): Promise<number | null> => {
    const last = held.current;
    held.current = null;
    return last ? last.drag.commit(last.shift(last.way)) : null;
  };
  const isArrow = (key: string): boolean => ACROSS.has(key) || (options.isRaised && UP_AND_DOWN.has(key));
  return {
    onPointerDown: (down) => {
      if (down.button === 0) giveUp.current = dragKey(session, options, down);
    },
    onKeyDown: (event) => {
      if (event.key !== "Escape" || !held.current) return isArrow(event.key) && nudgeKey(session, options, event, held);
      held.current.drag.cancel();
      held.current = null;
      return true;
    },
    onKeyUp: (event) => {
      if (!isArrow(event.key)) return;
      void letGo().then((at) => {
        tellArrived(options, at);
      });
    },
    onBlur: () => void letGo(),
  };
}

/** Selects a key, and moves the selected ones with the pointer. Returns what gives the move up. */
function dragKey(session: Session, options: GestureOptions, down: PointerEvent): () => void {
  const { keys } = session;
  const { stack, isRaised } = options;
  // What is typed elsewhere is entered first: it is for the keys that are selected until now.
  (down.currentTarget as HTMLElement).focus();
  const { several, free } = session.touch;
  const adds = down.shiftKey || several.value;
  const selectIt = (): void => {
    if (!keys.selected.value.has(stack.id)) keys.select([stack], adds);
  };
  if (!adds) selectIt();
  const way = (event: PointerEvent): Way => ({
    right: event.clientX - down.clientX,
    down: event.clientY - down.clientY,
    isFree: event.altKey || free.value,
    isStraight: event.shiftKey,
  });
  const isDragged = ({ right, down }: Way): boolean =>
    Math.abs(right) >= SLACK_PX || (isRaised && Math.abs(down) >= SLACK_PX);
  let drag: KeyDrag | null = null;
  const listening = new AbortController();
  const stop = followPointer(
    down,
    (event) => {
      if (!drag && (keys.noEdits !== null || !isDragged(way(event)))) return;
      if (!drag) selectIt();
      drag ??= keys.drag(stack);
      drag.move(options.dragged(way(event)));
    },
    (event) => {
      listening.abort();
      if (event.type !== "pointerup") drag?.cancel();
      else if (drag)
        void drag.commit(options.dragged(way(event))).then((at) => {
          tellArrived(options, at);
        });
      else options.click(adds);
    },
  );
  const giveUp = (): void => {
    if (listening.signal.aborted) return;
    listening.abort();
    stop();
    drag?.cancel();
  };
  onEscape(giveUp, listening.signal);
  return giveUp;
}

function tellArrived({ arrived }: GestureOptions, at: number | null): void {
  if (at !== null)
    requestAnimationFrame(() => {
      arrived(at);
    });
}

function onEscape(act: () => void, signal: AbortSignal): void {
  addEventListener(
    "keydown",
    (event) => {
      if (event.key !== "Escape") return;
      event.preventDefault();
      event.stopPropagation();
      act();
    },
    { capture: true, signal },
  );
}

/** Moves the selected keys by an arrow key; returns whether they may be moved. */
function nudgeKey(
  session: Session,
  { stack, nudged }: GestureOptions,
  { key, altKey, shiftKey }: KeyboardEvent,
  held: { current: HeldKey | null },
): boolean {
  const { keys } = session;
  if (keys.noEdits !== null || (keys.isDragged && !held.current)) return false;
  if (!keys.selected.value.has(stack.id)) keys.select([stack]);
  const size = altKey ? 0.1 : shiftKey ? 10 : 1;
  const step = key === "ArrowRight" || key === "ArrowDown" ? size : -size;
  const {
    drag,
    way: { right, down },
    shift,
  } = held.current ?? { drag: keys.drag(stack), way: { right: 0, down: 0 }, shift: nudged };
  const across = ACROSS.has(key);
  const way = {
    right: across ? right + step : right,
    down: across ? down : down + step,
    isFree: true,
    isStraight: false,
  };
  held.current = { drag, way, shift };
  drag.move(shift(way));
  return true;
}
