/** A menu of commands, with what their keys are; those that can do nothing now say why. */

import type { JSX } from "preact";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Command } from "../commands/command";
import { placeOf, shownKeys } from "../commands/table";
import { useFloating, type Anchor } from "../floating";

interface CommandMenuProps {
  readonly editor: Editor;
  readonly label: string;
  readonly commands: readonly Command[];
  readonly anchor: Anchor;
  readonly close: () => void;
  /** Goes to the menu beside it, by the arrow keys to the left and the right. */
  readonly onAside?: (by: 1 | -1) => void;
}

export function CommandMenu({ editor, label, commands, anchor, close, onAside }: CommandMenuProps): JSX.Element {
  const list = useRef<HTMLDivElement>(null);
  const opener = useRef(document.activeElement);
  useFloating(anchor, list, "bottom-start");
  useLayoutEffect(() => {
    itemsOf(list.current)[0]?.focus();
  }, [commands]);
  useOutside(list, close, onAside !== undefined);
  const leave = (): void => {
    close();
    if (opener.current instanceof HTMLElement) opener.current.focus();
  };
  return (
    <div
      ref={list}
      class="menu-list command-menu"
      role="menu"
      aria-label={label}
      tabIndex={-1}
      onKeyDown={(event) => {
        if (event.key === "Escape" || event.key === "Tab") leave();
        else if (event.key === "ArrowRight" && onAside) onAside(1);
        else if (event.key === "ArrowLeft" && onAside) onAside(-1);
        else if (event.ctrlKey || event.metaKey || !walk(list.current, event.key)) {
          event.stopPropagation(); // no shortcuts while a menu is open
          return;
        }
        event.preventDefault();
        event.stopPropagation();
      }}
    >
      {commands.map((command) => (
        <Item
          key={command.name}
          command={command}
          refusal={command.refusal(placeOf(editor))}
          isOn={command.isOn?.(placeOf(editor))}
          act={() => {
            leave();
            command.act(placeOf(editor));
          }}
        />
      ))}
    </div>
  );
}

interface ItemProps {
  readonly command: Command;
  readonly refusal: string | null;
  readonly isOn: boolean | undefined;
  readonly act: () => void;
}

/** An item that can do nothing is still come to, so that it can say why. */
function Item({ command, refusal, isOn, act }: ItemProps): JSX.Element {
  return (
    <button
      type="button"
      role={isOn === undefined ? "menuitem" : "menuitemcheckbox"}
      class="menu-item"
      tabIndex={-1}
      aria-checked={isOn}
      aria-disabled={refusal !== null}
      title={refusal ?? undefined}
      onClick={() => {
        if (refusal === null) act();
      }}
    >
      <span>
        {isOn !== undefined && (
          <i class="tick" aria-hidden="true">
            {isOn ? "✓" : ""}
          </i>
        )}
        {command.name}
      </span>
      {command.keys.length > 0 && <kbd>{shownKeys(command)}</kbd>}
    </button>
  );
}

/** @param isOfBar whether the bar closes and changes it itself. */
function useOutside(list: { current: HTMLElement | null }, close: () => void, isOfBar: boolean): void {
  useEffect(() => {
    const outside = (event: PointerEvent): void => {
      const target = event.target instanceof Element ? event.target : null;
      if (!list.current?.contains(target) && !(isOfBar && target?.closest("[role=menubar]"))) close();
    };
    addEventListener("pointerdown", outside, { capture: true });
    return () => {
      removeEventListener("pointerdown", outside, { capture: true });
    };
  }, [list, close, isOfBar]);
}

function itemsOf(list: HTMLElement | null): HTMLElement[] {
  return [...(list?.querySelectorAll<HTMLElement>("[role^=menuitem]") ?? [])];
}

/** Goes to another item by an arrow key, or by the first letter of its name; returns whether it did. */
function walk(list: HTMLElement | null, key: string): boolean {
  const all = itemsOf(list);
  const at = all.findIndex((item) => item === document.activeElement);
  if (key === "ArrowDown") all[(at + 1) % all.length]?.focus();
  else if (key === "ArrowUp") all.at(at - 1)?.focus();
  else if (key === "Home") all[0]?.focus();
  else if (key === "End") all.at(-1)?.focus();
  else if (/^\p{L}$/u.test(key)) {
    const after = [...all.slice(at + 1), ...all.slice(0, at + 1)];
    const isNamed = (item: HTMLElement): boolean =>
      item.querySelector("span")?.lastChild?.textContent?.toLowerCase().startsWith(key.toLowerCase()) ?? false;
    after.find(isNamed)?.focus();
  } else return false;
  return true;
}
