/** Gestures that enlarge and move the picture: wheel and pinch, the middle button, Space held down, one finger. */

import type { RefObject } from "preact";
import { useEffect } from "preact/hooks";
import type { Place } from "../../editor/picks";
import type { Session } from "../../editor/session";
import { followPointer } from "../hooks";
import { controlOf } from "../own_keys";

/** Factor of a wheel's turn of one px, and of one of trackpads, which pinch in smaller steps. */
const WHEEL_FACTOR = 1.002;
const PINCH_FACTOR = 1.01;
/** Turn from which a wheel is no trackpad, px. */
const WHEEL_PX = 50;
/** Distance from which a finger moves the picture, CSS px. */
const SLACK_PX = 8;

/** Enlarges and moves the picture of a session by gestures in its surround. */
export function useZoomGestures(ref: RefObject<HTMLElement | null>, session: Session): void {
  useEffect(() => {
    const surround = ref.current;
    if (!surround) return undefined;
    const stop = listen(surround, session);
    const unfollow = session.crosshair.at.subscribe((at) => {
      if (at && session.crosshair.isHeld.peek()) session.zoom.reveal(at);
    });
    return () => {
      stop();
      unfollow();
    };
  }, [ref, session]);
}

/** Listens until what is returned ends that. Others hear of a gesture only once this has not taken it. */
function listen(surround: HTMLElement, session: Session): () => void {
  const hand = new Hand(surround, session);
  const listening = new AbortController();
  const { signal } = listening;
  const turn = (event: WheelEvent): void => {
    turnWheel(event, surround, session);
  };
  surround.addEventListener("wheel", turn, { signal, passive: false });
  const first = { signal, capture: true };
  surround.addEventListener("pointerdown", hand.down, first);
  surround.addEventListener("pointermove", hand.move, first);
  surround.addEventListener("pointerup", hand.up, first);
  surround.addEventListener("pointercancel", hand.up, first);
  surround.addEventListener("click", hand.click, first);
  window.addEventListener("keydown", hand.press, first);
  window.addEventListener("keyup", hand.release, first);
  return () => {
    listening.abort();
  };
}

function turnWheel(event: WheelEvent, surround: HTMLElement, { zoom }: Session): void {
  const turn = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 40 : 1;
  const [x, y] = [event.deltaX * turn, event.deltaY * turn];
  if (event.ctrlKey || event.metaKey || event.altKey) {
    const factor = Math.abs(y) < WHEEL_PX ? PINCH_FACTOR : WHEEL_FACTOR;
    zoom.by(factor ** -y, placeIn(surround, event));
  } else if (zoom.placing.value) {
    const isTurned = event.shiftKey && x === 0;
    zoom.move(isTurned ? -y : -x, isTurned ? 0 : -y);
  } else return;
  event.preventDefault();
}

/** Where in the picture a pointer is, from its top left corner; outside of it, too. */
function placeIn(surround: HTMLElement, { clientX, clientY }: Point): Place {
  const frame = surround.querySelector(".picture")?.getBoundingClientRect() ?? surround.getBoundingClientRect();
  return [(clientX - frame.left) / frame.width, (clientY - frame.top) / frame.height];
}

type Point = Pick<PointerEvent, "clientX" | "clientY">;

/** The pointers on the surround, and Space. */
class Hand {
  readonly #surround: HTMLElement;
  readonly #session: Session;
  readonly #fingers = new Map<number, Point>();
  /** Whether the click that follows is that of a gesture, and does nothing. */
  #isGesture = false;
  /** Whether a finger has gone far enough to move the picture. */
  #isMoving = false;
  #hasMoved = false;
  #isSpaceHeld = false;

  constructor(surround: HTMLElement, session: Session) {
    [this.#surround, this.#session] = [surround, session];
  }

  readonly down = (event: PointerEvent): void => {
    if (event.pointerType === "touch") this.#touch(event);
    else if (event.button === 1 || (event.button === 0 && this.#isSpaceHeld)) this.#drag(event);
    else this.#isGesture = false;
  };

  readonly move = (event: PointerEvent): void => {
    const before = this.#fingers.get(event.pointerId);
    if (!before || this.#session.zoom.room === null) return;
    const [x, y] = [event.clientX - before.clientX, event.clientY - before.clientY];
    const { zoom } = this.#session;
    const other = [...this.#fingers].find(([id]) => id !== event.pointerId)?.[1];
    if (other) {
      const [old, now] = [distance(before, other), distance(event, other)];
      if (old > 0) zoom.by(now / old, placeIn(this.#surround, middle(event, other)));
      zoom.move(x / 2, y / 2);
    } else if (zoom.placing.value && (this.#isMoving || Math.hypot(x, y) >= SLACK_PX)) {
      this.#isMoving = true;
      this.#take();
      zoom.move(x, y);
    } else return;
    this.#fingers.set(event.pointerId, event);
  };

  readonly up = ({ pointerId }: PointerEvent): void => {
    this.#fingers.delete(pointerId);
    if (this.#fingers.size === 0) this.#isMoving = false;
  };

  /** Drops the click of a gesture. */
  readonly click = (event: MouseEvent): void => {
    if (!this.#isGesture) return;
    this.#isGesture = false;
    event.stopPropagation();
    event.preventDefault();
  };

  /** Holds Space for a drag where the pointer is on an enlarged picture; it plays when it is let go without one. */
  readonly press = (event: KeyboardEvent): void => {
    if (event.key !== " " || event.ctrlKey || event.altKey || event.metaKey) return;
    const { zoom, pointer } = this.#session;
    const focused = event.target instanceof Element ? controlOf(event.target) : null;
    const isFree = focused === null || focused === "radio" || focused === "button";
    const isWanted = zoom.placing.value !== null && pointer.value !== null && isFree;
    if (!this.#isSpaceHeld && (!isWanted || document.querySelector("dialog[open]"))) return;
    event.preventDefault();
    if (event.repeat) return;
    [this.#isSpaceHeld, this.#hasMoved] = [true, false];
    this.#surround.classList.add("held");
  };

  readonly release = (event: KeyboardEvent): void => {
    if (event.key !== " " || !this.#isSpaceHeld) return;
    event.preventDefault();
    this.#isSpaceHeld = false;
    this.#surround.classList.remove("held");
    if (!this.#hasMoved) this.#session.playhead.toggle();
  };

  #touch(event: PointerEvent): void {
    if (this.#fingers.size === 0) this.#isGesture = false;
    const isOnMarker =
      event.target instanceof Element && event.target.closest("button, [role=slider], .drawing-sheet") !== null;
    if (this.#fingers.size === 0 && isOnMarker) return;
    this.#fingers.set(event.pointerId, event);
    if (this.#fingers.size < 2) return;
    event.stopPropagation();
    this.#take();
  }

  #drag(event: PointerEvent): void {
    event.preventDefault();
    event.stopPropagation();
    this.#take();
    let before: Point = event;
    followPointer(
      event,
      (now) => {
        this.#hasMoved = true;
        this.#session.zoom.move(now.clientX - before.clientX, now.clientY - before.clientY);
        before = now;
      },
      (last) => {
        this.#session.pointer.value = placeIn(this.#surround, last); // which left the picture as it was held
      },
    );
  }

  /** Takes the pointer from what else would follow it. */
  #take(): void {
    this.#isGesture = true;
    this.#hasMoved = true;
    this.#session.pulls.aiming.value = false;
  }
}

function distance(one: Point, other: Point): number {
  return Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
}

function middle(one: Point, other: Point): Point {
  return { clientX: (one.clientX + other.clientX) / 2, clientY: (one.clientY + other.clientY) / 2 };
}
