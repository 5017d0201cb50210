/** A button that opens a list below it. */

import type { ComponentChildren, JSX } from "preact";
import type { Placement } from "@floating-ui/dom";
import { useEffect, useRef, useState } from "preact/hooks";
import { useFloating } from "../floating";

interface MenuProps {
  /** Id of the list. */
  readonly name: string;
  readonly label: string;
  /** Of the button, read aloud and on hover, where its content does not say enough. */
  readonly title?: string;
  readonly kind?: "primary";
  readonly disabled?: boolean;
  /** Content of the button. */
  readonly head: ComponentChildren;
  /** Where the list is. */
  readonly placement?: Placement;
  readonly onOpen?: () => void;
  /** Content of the list; it is given what closes the list. */
  readonly children: (close: () => void) => ComponentChildren;
}

export function Menu(props: MenuProps): JSX.Element {
  const { name, label, title, kind, disabled = false, head, placement = "bottom-end", onOpen, children } = props;
  const [open, setOpen] = useState(false);
  const ref = useRef<HTMLDivElement>(null);
  const button = useRef<HTMLButtonElement>(null);
  const list = useRef<HTMLDivElement>(null);
  useFloating(button, list, placement, open);
  useEffect(() => {
    if (!open) return;
    const outside = (event: Event): void => {
      const isEscape = event instanceof KeyboardEvent && event.key === "Escape";
      if (event instanceof KeyboardEvent ? !isEscape : ref.current?.contains(event.target as Node)) return;
      if (isEscape) event.preventDefault(); // it stops and deselects nothing else
      if (isEscape && ref.current?.contains(document.activeElement)) button.current?.focus();
      setOpen(false);
    };
    document.addEventListener("pointerdown", outside);
    document.addEventListener("keydown", outside);
    return () => {
      document.removeEventListener("pointerdown", outside);
      document.removeEventListener("keydown", outside);
    };
  }, [open]);
  return (
    <div class="menu" ref={ref}>
      <button
        ref={button}
        type="button"
        class={kind ? `button ${kind}` : "button"}
        aria-label={title}
        title={title}
        aria-expanded={open}
        aria-controls={name}
        disabled={disabled}
        onClick={() => {
          if (!open) onOpen?.();
          setOpen(!open);
        }}
      >
        {head}
      </button>
      {open && (
        <div ref={list} id={name} class="menu-list" role="group" aria-label={label}>
          {children(() => {
            setOpen(false);
          })}
        </div>
      )}
    </div>
  );
}
