/** Lists of options below a box that is typed in. */

import Combobox from "@github/combobox-nav";
import type { RefObject } from "preact";
import { useLayoutEffect } from "preact/hooks";

/** What a box that is always a combobox says of itself, which the library takes away with the list. */
const OWN = ["role", "aria-controls", "aria-autocomplete"] as const;

/**
 * Walks a list by the arrow keys of its box, and clicks by Enter the option that was come to.
 *
 * @param typed text by which the list was made.
 * @param isFirstReady whether the first option stands ready for Enter.
 * @param isOpen whether the list is there.
 */
export function useListbox(
  input: RefObject<HTMLInputElement | null>,
  list: RefObject<HTMLElement | null>,
  typed: string,
  isFirstReady: boolean,
  isOpen = true,
): void {
  // At once, so that Enter finds what was typed just before.
  useLayoutEffect(() => {
    const box = input.current;
    if (!isOpen || !box || !list.current) return;
    const own = OWN.map((name) => [name, box.getAttribute(name)] as const);
    const combobox = new Combobox(box, list.current, {
      firstOptionSelectionMode: isFirstReady ? "selected" : "none",
      tabInsertsSuggestions: false,
    });
    combobox.start();
    return () => {
      combobox.destroy();
      for (const [name, value] of own) if (value !== null) box.setAttribute(name, value);
      if (box.role === "combobox") box.ariaExpanded = "false";
    };
  }, [input, list, typed, isFirstReady, isOpen]);
}
