/** Keys that work anywhere on the page, except where the focused control has a use of its own for them. */

import type { Editor } from "../editor/editor";
import type { Command } from "./commands/command";
import { commandOf, isReserved, placeOf } from "./commands/table";
import { chooseRadio, controlOf, usesKey } from "./own_keys";

/** Time from which a key is held down, and not pressed, ms. */
const HELD_MS = 300;

/** A key that is down, and its command. */
interface Held {
  readonly command: Command;
  readonly code: string;
  readonly since: number;
}

export function listenToKeys(target: Window, editor: Editor): void {
  const origin = new FocusOrigin(target);
  let isSpaceTaken = false;
  let held: Held | null = null;
  target.addEventListener("keydown", (event) => {
    if (event.defaultPrevented || document.querySelector("dialog[open]")) return;
    const focused = event.target instanceof Element ? event.target : null;
    if (focused && chooseRadio(focused, event)) event.preventDefault();
    if (focused && usesKey(controlOf(focused), event, origin.isKeyboard)) return;
    const place = placeOf(editor);
    const command = commandOf(event, place);
    if (command || isReserved(event)) event.preventDefault();
    if (!command) return;
    isSpaceTaken = event.key === " ";
    if (!event.repeat || command.repeats) command.act(place);
    if (!event.repeat) held = command.letGo ? { command, code: event.code, since: event.timeStamp } : null;
  });
  target.addEventListener("keyup", ({ code, timeStamp }) => {
    if (held?.code !== code) return;
    if (timeStamp - held.since >= HELD_MS) held.command.letGo?.(placeOf(editor));
    held = null;
  });
  // Some browsers press a button when Space goes up.
  target.addEventListener("keyup", (event) => {
    if (event.key !== " " || !isSpaceTaken) return;
    event.preventDefault();
    isSpaceTaken = false;
  });
}

/** Whether the keyboard has brought the focus where it is, and not the pointer. */
class FocusOrigin {
  isKeyboard = false;
  #isKeyLast = false;

  constructor(target: Window) {
    const heard =
      (isKey: boolean): (() => void) =>
      () => {
        this.#isKeyLast = isKey;
      };
    target.addEventListener("keydown", heard(true), { capture: true });
    target.addEventListener("pointerdown", heard(false), { capture: true });
    target.addEventListener("focusin", () => {
      this.isKeyboard = this.#isKeyLast;
    });
  }
}
