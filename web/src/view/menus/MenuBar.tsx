/** The menus of all commands; on a narrow page one button that opens the list of them. */

import type { JSX } from "preact";
import { useCallback, useRef, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import { MENUS, type MenuName } from "../commands/command";
import { commandsOf } from "../commands/table";
import { Icon } from "../icons";
import { CommandMenu } from "./CommandMenu";

export function MenuBar({ editor }: { editor: Editor }): JSX.Element {
  const [open, setOpen] = useState<MenuName | null>(null);
  const [entry, setEntry] = useState<MenuName>("Shot");
  const bar = useRef<HTMLDivElement>(null);
  const head = useRef<HTMLElement | null>(null);
  const headOf = (name: MenuName): HTMLElement | null =>
    bar.current?.querySelector<HTMLElement>(`[data-menu="${name}"]`) ?? null;
  const close = useCallback(() => {
    setOpen(null);
  }, []);
  const show = (name: MenuName): void => {
    head.current = headOf(name);
    head.current?.focus();
    setEntry(name);
    setOpen(name);
  };
  const goTo = (name: MenuName): void => {
    setEntry(name);
    headOf(name)?.focus();
  };
  return (
    <>
      <AllCommands editor={editor} />
      <div ref={bar} class="menu-bar" role="menubar" aria-label="Commands">
        {MENUS.map((name) => (
          <Head
            key={name}
            name={name}
            isEntry={entry === name}
            open={open}
            toggle={() => {
              if (open === name) close();
              else show(name);
            }}
            show={show}
            goTo={goTo}
          />
        ))}
      </div>
      {open && (
        <CommandMenu
          key={open}
          editor={editor}
          label={open}
          commands={commandsOf(open)}
          anchor={head}
          close={close}
          onAside={(by) => {
            show(after(open, by));
          }}
        />
      )}
    </>
  );
}

interface HeadProps {
  readonly name: MenuName;
  /** Whether Tab comes to it. */
  readonly isEntry: boolean;
  /** The menu that is open. */
  readonly open: MenuName | null;
  readonly toggle: () => void;
  readonly show: (name: MenuName) => void;
  readonly goTo: (name: MenuName) => void;
}

function Head({ name, isEntry, open, toggle, show, goTo }: HeadProps): JSX.Element {
  return (
    <button
      type="button"
      class="menu-head"
      role="menuitem"
      data-menu={name}
      tabIndex={isEntry ? 0 : -1}
      aria-haspopup="menu"
      aria-expanded={open === name}
      onClick={toggle}
      onPointerEnter={({ pointerType }) => {
        if (pointerType === "mouse" && open !== null && open !== name) show(name);
      }}
      onKeyDown={(event) => {
        if (event.key === "ArrowRight") goTo(after(name, 1));
        else if (event.key === "ArrowLeft") goTo(after(name, -1));
        else if (event.key === "ArrowDown") show(name);
        else return;
        event.preventDefault();
      }}
    >
      {name}
    </button>
  );
}

function after(name: MenuName, by: number): MenuName {
  return MENUS.at((MENUS.indexOf(name) + by) % MENUS.length) ?? name;
}

/** Opens the list of all commands, where there is no room for the menus. */
function AllCommands({ editor }: { editor: Editor }): JSX.Element {
  return (
    <button
      type="button"
      class="button icon-only all-commands"
      aria-label="All commands"
      title="All commands (Ctrl K)"
      onClick={() => (editor.paletteOpen.value = true)}
    >
      <Icon name="menu" />
    </button>
  );
}
