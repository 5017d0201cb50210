/** The menu of the keys: it opens where the pointer is, or at the focused key by the menu key of the keyboard. */

import type { JSX } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";
import { KEY_ACTIONS } from "../../editor/key_actions";
import type { Session } from "../../editor/session";

/** Where a menu is open, CSS px of the window. */
export interface MenuPlace {
  readonly x: number;
  readonly y: number;
}

interface KeyMenuProps {
  readonly session: Session;
  readonly place: MenuPlace;
  readonly close: () => void;
}

export function KeyMenu({ session, place, close }: KeyMenuProps): JSX.Element {
  const list = useRef<HTMLDivElement>(null);
  const opener = useRef(document.activeElement);
  useLayoutEffect(() => {
    items(list.current)[0]?.focus();
    const outside = (event: PointerEvent): void => {
      if (!list.current?.contains(event.target as Node)) close();
    };
    addEventListener("pointerdown", outside, { capture: true });
    return () => {
      removeEventListener("pointerdown", outside, { capture: true });
    };
  }, [close]);
  const leave = (): void => {
    close();
    if (opener.current instanceof HTMLElement) opener.current.focus();
  };
  return (
    <div
      ref={list}
      class="menu-list key-menu"
      role="menu"
      aria-label="Keys"
      style={{ left: `min(${place.x}px, 100vw - 230px)`, bottom: `max(100vh - ${place.y}px, 8px)` }}
      onKeyDown={(event) => {
        if (event.key === "Escape" || event.key === "Tab") leave();
        else if (!walk(list.current, event.key)) return;
        event.preventDefault();
        event.stopPropagation();
      }}
    >
      {KEY_ACTIONS.map(({ label, keys, isPossible, act }) => (
        <button
          key={label}
          type="button"
          role="menuitem"
          class="menu-item"
          disabled={!isPossible(session.keys)}
          onClick={() => {
            leave();
            act(session.keys);
          }}
        >
          {label}
          <kbd>{keys}</kbd>
        </button>
      ))}
    </div>
  );
}

function items(list: HTMLElement | null): HTMLElement[] {
  return [...(list?.querySelectorAll<HTMLElement>("[role=menuitem]:enabled") ?? [])];
}

/** Goes to another item by an arrow key; returns whether it was one. */
function walk(list: HTMLElement | null, key: string): boolean {
  const all = items(list);
  const at = all.findIndex((item) => item === document.activeElement);
  if (key === "ArrowDown") all[(at + 1) % all.length]?.focus();
  else if (key === "ArrowUp") all.at(at - 1)?.focus();
  else if (key === "Home") all[0]?.focus();
  else if (key === "End") all.at(-1)?.focus();
  else return false;
  return true;
}
