/** The list of all commands, searched by what is typed. */

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Place } from "../commands/command";
import { useListbox } from "../controls/listbox";
import { COMMANDS, found, placeOf, shownKeys } from "../commands/table";

export function Palette({ editor }: { editor: Editor }): JSX.Element {
  const dialog = useRef<HTMLDialogElement>(null);
  const [place, setPlace] = useState<Place | null>(null);
  const isOpen = editor.paletteOpen.value;
  useEffect(() => {
    if (isOpen) {
      setPlace(placeOf(editor)); // before the dialog takes the keyboard
      dialog.current?.showModal();
    } else {
      dialog.current?.close();
      setPlace(null);
    }
  }, [editor, isOpen]);
  const close = (): void => {
    editor.paletteOpen.value = false;
  };
  return (
    <dialog
      ref={dialog}
      class="palette"
      aria-label="All commands"
      onClose={close}
      onClick={(event) => {
        if (event.target === dialog.current) close(); // beside it
      }}
    >
      {isOpen && place && <Search place={{ ...place, session: editor.session.value }} close={close} />}
    </dialog>
  );
}

function Search({ place, close }: { place: Place; close: () => void }): JSX.Element {
  const [typed, setTyped] = useState("");
  const input = useRef<HTMLInputElement>(null);
  const list = useRef<HTMLUListElement>(null);
  const commands = found(typed);
  useListbox(input, list, typed, true);
  useEffect(() => {
    input.current?.focus();
  }, []);
  return (
    <>
      <input
        ref={input}
        class="text-field"
        type="text"
        placeholder="What shall be done?"
        aria-label="Search in all commands"
        autocomplete="off"
        spellcheck={false}
        value={typed}
        onInput={({ currentTarget }) => {
          setTyped(currentTarget.value);
        }}
      />
      <ul
        ref={list}
        role="listbox"
        aria-label="Commands"
        class="palette-list"
        onClick={(event) => {
          const row = event.target instanceof Element ? event.target.closest<HTMLElement>("[data-command]") : null;
          const command = COMMANDS[Number(row?.dataset.command)];
          if (command?.refusal(place) !== null) return;
          close();
          command.act(place);
        }}
      >
        {commands.map((command) => {
          const refusal = command.refusal(place);
          const at = COMMANDS.indexOf(command);
          return (
            <li key={at} id={`command-${at}`} role="option" data-command={at} aria-disabled={refusal !== null}>
              <span>
                <span class="muted">{command.menu}</span> {command.name}
                {command.isOn?.(place) && " ✓"}
                {refusal !== null && <small>{refusal}</small>}
              </span>
              {command.keys.length > 0 && <kbd>{shownKeys(command)}</kbd>}
            </li>
          );
        })}
      </ul>
      <p class="muted" role="status">
        {commands.length === 0 ? "No command is called that." : ""}
      </p>
    </>
  );
}
