/** A choice among many, found by typing: the box has what is chosen, and a list of what has all words that are typed opens below it. */

import type { JSX, RefObject } from "preact";
import { useId, useLayoutEffect, useRef, useState } from "preact/hooks";
import { useFloating } from "../floating";
import { useListbox } from "./listbox";

export interface Option {
  readonly id: string;
  readonly name: string;
  /** Words that find it beside those of its name. */
  readonly keywords?: string;
}

interface SearchedChoiceProps {
  readonly label: string;
  /** Name of what is chosen now. */
  readonly shown: string;
  /** Under their headings, of which one may be empty. */
  readonly groups: readonly (readonly [heading: string, options: readonly Option[]])[];
  readonly onChoose: (id: string) => void;
}

export function SearchedChoice({ label, shown, groups, onChoose }: SearchedChoiceProps): JSX.Element {
  const [isOpen, setOpen] = useState(false);
  const [typed, setTyped] = useState<string | null>(null);
  const input = useRef<HTMLInputElement>(null);
  const list = useRef<HTMLDivElement>(null);
  const id = useId();
  const search = typed ?? "";
  useFloating(input, list, "bottom-start", isOpen);
  useListbox(input, list, search, search !== "", isOpen);
  useNameSelected(input, typed === null, isOpen, shown);
  const show = (isShown: boolean, text: string | null = null): void => {
    setOpen(isShown);
    setTyped(text);
  };
  return (
    <div class="searched-choice">
      <input
        ref={input}
        type="text"
        class="text-field"
        role="combobox"
        aria-label={label}
        aria-expanded={isOpen}
        aria-controls={id}
        aria-autocomplete="list"
        autocomplete="off"
        spellcheck={false}
        value={typed ?? shown}
        onFocus={({ currentTarget }) => {
          currentTarget.select();
        }}
        onClick={() => {
          if (!isOpen) show(true);
        }}
        onInput={({ currentTarget }) => {
          show(true, currentTarget.value);
        }}
        onBlur={() => {
          show(false);
        }}
        onKeyDown={(event) => {
          const opens = event.key === "ArrowDown" || event.key === "ArrowUp" || event.key === "Enter";
          if (isOpen ? event.key !== "Escape" : !opens) return;
          show(!isOpen);
          event.preventDefault();
        }}
      />
      {isOpen && (
        <Options
          list={list}
          id={id}
          label={label}
          groups={groups}
          search={search}
          shown={shown}
          onChoose={(chosen) => {
            show(false);
            onChoose(chosen);
          }}
        />
      )}
    </div>
  );
}

/** Selects the name of what is chosen, so that what is typed next takes its place. */
function useNameSelected(
  { current: input }: RefObject<HTMLInputElement | null>,
  isName: boolean,
  isOpen: boolean,
  shown: string,
): void {
  useLayoutEffect(() => {
    if (isName && document.activeElement === input) input?.select();
  }, [input, isName, isOpen, shown]);
}

interface OptionsProps extends SearchedChoiceProps {
  readonly list: RefObject<HTMLDivElement | null>;
  readonly id: string;
  readonly search: string;
}

function Options({ list, id, label, onChoose, ...found }: OptionsProps): JSX.Element {
  return (
    <div
      ref={list}
      id={id}
      role="listbox"
      aria-label={label}
      class="menu-list choices"
      onPointerDown={(event) => {
        event.preventDefault(); // the keyboard stays in the box
      }}
      onClick={({ target }) => {
        const chosen = target instanceof Element ? target.closest<HTMLElement>("[data-option]") : null;
        if (chosen?.dataset.option !== undefined) onChoose(chosen.dataset.option);
      }}
    >
      <Found id={id} {...found} />
    </div>
  );
}

/** The options that have all words of what is typed. */
function Found({ groups, search, shown, id }: Omit<OptionsProps, "list" | "label" | "onChoose">): JSX.Element {
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  const found = groups
    .map(([heading, options]) => ({
      heading,
      options: options.filter(({ name, keywords = "" }) => {
        const text = `${heading} ${name} ${keywords}`.toLowerCase();
        return words.every((word) => text.includes(word));
      }),
    }))
    .filter(({ options }) => options.length > 0);
  if (found.length === 0)
    return (
      <p class="muted" role="option" aria-disabled="true" aria-selected="false">
        Nothing is called that.
      </p>
    );
  return (
    <>
      {found.map(({ heading, options }) => (
        <div key={heading} role="group" aria-label={heading || undefined}>
          {heading !== "" && (
            <p class="menu-heading" aria-hidden="true">
              {heading}
            </p>
          )}
          {options.map((option) => (
            <div
              key={option.id}
              id={`${id}-${option.id}`}
              role="option"
              class="choice-option"
              data-option={option.id}
              aria-selected="false"
            >
              {option.name}
              {option.name === shown && " ✓"}
            </div>
          ))}
        </div>
      ))}
    </>
  );
}
