/** Keys that work anywhere on the page, except where the focused control has a use of its own for them. */

import type { Editor } from "../editor/editor";
import { commandOf, isReserved, placeOf } from "./commands/table";
import { chooseRadio, controlOf, usesKey } from "./own_keys";

export function listenToKeys(target: Window, editor: Editor): void {
  const origin = new FocusOrigin(target);
  let isSpaceTaken = false;
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
