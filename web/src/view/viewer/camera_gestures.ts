/** Gestures that move the camera: drags with Alt, and drags and keys while the camera is moved. */

import type { RefObject } from "preact";
import { useEffect } from "preact/hooks";
import type { CameraMoves } from "../../editor/camera_moves";
import type { FrameNotes } from "../../editor/frame_notes";
import type { Session } from "../../editor/session";
import type { Drag, MoveKind } from "../../model/camera_moves";
import { followPointer } from "../hooks";
import { controlOf, usesKey } from "../own_keys";

/** Distance from which a press of the left button is a drag, CSS px. */
const SLACK_PX = 4;
const BY_BUTTON: readonly MoveKind[] = ["orbit", "pan", "dolly"];
/** Parts of a picture by which a key orbits and pans, and of which it dollies. */
const [ORBIT_STEP, PAN_STEP, DOLLY_STEP] = [1 / 36, 1 / 20, 1 / 20];

/** Moves the camera of a session by gestures in the picture's surround. */
export function useCameraGestures(ref: RefObject<HTMLElement | null>, session: Session): void {
  useEffect(() => {
    const surround = ref.current;
    if (!surround) return undefined;
    const hand = new CameraHand(surround, session);
    const listening = new AbortController();
    const first = { signal: listening.signal, capture: true };
    surround.addEventListener("pointerdown", hand.down, first);
    surround.addEventListener("click", hand.click, first);
    surround.addEventListener("contextmenu", hand.menu, first);
    window.addEventListener("keydown", hand.press, first);
    window.addEventListener("keyup", hand.release, first);
    window.addEventListener("blur", hand.leave, { signal: listening.signal });
    return () => {
      listening.abort();
      hand.leave();
    };
  }, [ref, session]);
}

/** What the pointer can do on a picture: move its camera, or draw on it. */
interface Hands {
  readonly cameraMoves: Pick<CameraMoves, "refusal" | "isOn" | "kind">;
  readonly frameNotes: Pick<FrameNotes, "isDrawing">;
}

type Press = Pick<PointerEvent, "button" | "altKey" | "shiftKey" | "ctrlKey" | "metaKey" | "pointerType" | "isPrimary">;

/** The move that a press of a button begins; null for none, as while the pointer draws. */
export function kindOf(event: Press, { cameraMoves: moves, frameNotes }: Hands): MoveKind | null {
  const { button, altKey, shiftKey, ctrlKey, metaKey } = event;
  if (moves.refusal !== null || frameNotes.isDrawing.value) return null;
  if (altKey) return event.pointerType === "touch" ? null : (BY_BUTTON[button] ?? null);
  if (!moves.isOn.value || !event.isPrimary) return null;
  if (button !== 0) return BY_BUTTON[button] ?? null;
  if (shiftKey) return "pan";
  return ctrlKey || metaKey ? "dolly" : moves.kind.value;
}

/** The move of a key while the camera is moved; null for none. */
function keyMove(event: KeyboardEvent): readonly [MoveKind, Drag] | null {
  if (event.ctrlKey || event.altKey || event.metaKey) return null;
  if (event.key === "PageUp") return ["dolly", [DOLLY_STEP, 0]];
  if (event.key === "PageDown") return ["dolly", [-DOLLY_STEP, 0]];
  const way = WAYS[event.key];
  if (!way) return null;
  const step = event.shiftKey ? PAN_STEP : ORBIT_STEP;
  return [event.shiftKey ? "pan" : "orbit", [way[0] * step, way[1] * step]];
}

/** The camera goes where the arrow points, so the picture goes the other way. */
const WAYS: Readonly<Record<string, Drag>> = {
  ArrowLeft: [1, 0],
  ArrowRight: [-1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

class CameraHand {
  readonly #surround: HTMLElement;
  readonly #session: Session;
  /** Whether the click that follows is that of a gesture, and does nothing. */
  #isGesture = false;
  /** The key that moves the camera now. */
  #key: string | null = null;

  constructor(surround: HTMLElement, session: Session) {
    [this.#surround, this.#session] = [surround, session];
  }

  readonly down = (event: PointerEvent): void => {
    this.#isGesture = false;
    const kind = kindOf(event, this.#session);
    const isOnControl = event.target instanceof Element && event.target.closest("button, [role=slider]") !== null;
    if (kind === null || (event.button === 0 && isOnControl) || this.#surround.classList.contains("held")) return;
    if (event.button === 0) {
      this.#wait(event, kind);
      return;
    }
    event.preventDefault();
    event.stopImmediatePropagation();
    this.#follow(event, kind);
  };

  /** Drops the click of a gesture. */
  readonly click = (event: MouseEvent): void => {
    if (!this.#isGesture) return;
    this.#isGesture = false;
    event.stopImmediatePropagation();
    event.preventDefault();
  };

  /** The right button dollies, where it can. */
  readonly menu = (event: MouseEvent): void => {
    const { cameraMoves } = this.#session;
    if (cameraMoves.refusal === null && (event.altKey || cameraMoves.isOn.value)) event.preventDefault();
  };

  readonly press = (event: KeyboardEvent): void => {
    const { cameraMoves, crosshair } = this.#session;
    if (!cameraMoves.isOn.value || cameraMoves.refusal !== null || document.querySelector("dialog[open]")) return;
    const focused = event.target instanceof Element ? event.target : null;
    const elsewhere = focused?.closest(".plan, .tracks, [role=menu], [role=listbox]") ?? null;
    if (crosshair.isHeld.value || elsewhere || (focused && usesKey(controlOf(focused), event, true))) return;
    const move = keyMove(event);
    if (!move) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    this.#key = event.key;
    cameraMoves.move(...move);
  };

  readonly release = ({ key }: KeyboardEvent): void => {
    if (key === this.#key) this.leave();
  };

  /** Ends what a key has begun. */
  readonly leave = (): void => {
    if (this.#key === null) return;
    this.#key = null;
    void this.#session.cameraMoves.end();
  };

  /** Waits for a drag: what is a click stays one, so that the pointer is not captured before. */
  #wait({ clientX, clientY, pointerId }: PointerEvent, kind: MoveKind): void {
    const waiting = new AbortController();
    const first = { signal: waiting.signal, capture: true };
    const stop = (): void => {
      waiting.abort();
    };
    window.addEventListener("pointerup", stop, first);
    window.addEventListener("pointercancel", stop, first);
    this.#surround.addEventListener(
      "pointermove",
      (now) => {
        if (now.pointerId !== pointerId || Math.hypot(now.clientX - clientX, now.clientY - clientY) < SLACK_PX) return;
        stop();
        this.#isGesture = true;
        this.#session.pulls.aiming.value = false;
        this.#follow(now, kind, [clientX, clientY]);
      },
      first,
    );
  }

  /** @param from where the drag began, CSS px. */
  #follow(down: PointerEvent, kind: MoveKind, from: readonly [number, number] = [down.clientX, down.clientY]): void {
    const { cameraMoves } = this.#session;
    const picture = this.#surround.querySelector(".picture")?.getBoundingClientRect();
    if (!picture) return;
    let [x, y] = from;
    const to = (now: PointerEvent): void => {
      cameraMoves.move(kind, [(now.clientX - x) / picture.width, (now.clientY - y) / picture.height]);
      [x, y] = [now.clientX, now.clientY];
    };
    const cancelling = new AbortController();
    const unfollow = followPointer(down, to, ({ type }) => {
      cancelling.abort();
      if (type === "pointercancel") cameraMoves.cancel();
      else void cameraMoves.end();
    });
    if (x !== down.clientX || y !== down.clientY) to(down);
    const cancel = (event: KeyboardEvent): void => {
      if (event.key !== "Escape") return;
      event.stopImmediatePropagation();
      cancelling.abort();
      unfollow();
      cameraMoves.cancel();
    };
    window.addEventListener("keydown", cancel, { signal: cancelling.signal, capture: true });
  }
}
