/** Places of menus: beside what opens them, and within the window. */

import { autoUpdate, computePosition, flip, offset, shift, size, type Placement } from "@floating-ui/dom";
import type { RefObject } from "preact";
import { useLayoutEffect } from "preact/hooks";

/** Free px between a menu and the edge of the window. */
const MARGIN_PX = 8;

/** What a menu is beside: an element, or a place of the window, CSS px. */
export type Anchor = RefObject<Element | null> | { readonly x: number; readonly y: number };

/** Keeps an element (`position: fixed`) beside an anchor while it is there; it scrolls where the window is too low for it. */
export function useFloating(
  anchor: Anchor,
  floating: RefObject<HTMLElement | null>,
  placement: Placement,
  isOpen = true,
): void {
  useLayoutEffect(() => {
    const [reference, element] = ["current" in anchor ? anchor.current : pointOf(anchor), floating.current];
    if (!isOpen || !reference || !element) return;
    const place = async (): Promise<void> => {
      const { x, y } = await computePosition(reference, element, {
        placement,
        strategy: "fixed",
        middleware: [
          offset("current" in anchor ? 4 : 0),
          flip({ padding: MARGIN_PX, crossAxis: false }),
          shift({ padding: MARGIN_PX }),
          size({
            padding: MARGIN_PX,
            apply: ({ availableHeight }) => {
              element.style.maxHeight = `${Math.max(availableHeight, 120)}px`;
            },
          }),
        ],
      });
      element.style.left = `${x}px`;
      element.style.top = `${y}px`;
    };
    return autoUpdate(reference, element, () => void place());
  }, [anchor, floating, placement, isOpen]);
}

function pointOf({ x, y }: { readonly x: number; readonly y: number }): {
  getBoundingClientRect: () => { [side in keyof Omit<DOMRect, "toJSON">]: number };
} {
  const rect = { x, y, left: x, right: x, top: y, bottom: y, width: 0, height: 0 };
  return { getBoundingClientRect: () => rect };
}
