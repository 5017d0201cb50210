/** A number that is typed. Enter or leaving the box enters it, Escape gives it up; what cannot be read stays, with a hint. */

import type { JSX } from "preact";
import { useEffect, useId, useState } from "preact/hooks";
import { Typing } from "./typing";

export interface TypedNumberProps {
  readonly label: string;
  readonly value: number;
  readonly format: (value: number) => string;
  readonly parse: (text: string) => number | null;
  /** Example of a value, shown with one that cannot be read. */
  readonly example: string;
  readonly kind?: "frame";
  readonly disabled?: boolean;
  readonly onTyped: (value: number) => void;
  /** Takes arrow keys, which change the value in steps, and Escape. */
  readonly onStep?: (event: KeyboardEvent) => void;
  /** Called when an arrow key is let go, and when the box is left. */
  readonly onStepped?: () => void;
}

export function TypedNumber(props: TypedNumberProps): JSX.Element {
  const { label, value, format, parse, example, kind, disabled = false, onStep, onStepped } = props;
  const { typing, enter } = useTyping(props);
  const hint = useId();
  const text = typing.text.value;
  const refused = typing.refused.value;
  return (
    <>
      <input
        type="text"
        class={kind ? `number ${kind}` : "number"}
        inputMode="decimal"
        autocomplete="off"
        spellcheck={false}
        disabled={disabled}
        aria-label={label}
        aria-invalid={text !== null && parse(text) === null}
        aria-describedby={refused ? hint : undefined}
        value={text ?? format(value)}
        onFocus={(event) => {
          event.currentTarget.select();
        }}
        onInput={(event) => {
          typing.type(event.currentTarget.value);
        }}
        onBlur={() => {
          enter();
          onStepped?.();
        }}
        onKeyDown={(event) => {
          if (event.key === "Enter") {
            enter();
            if (!typing.refused.peek()) event.currentTarget.blur();
          } else if (event.key === "Escape") {
            typing.giveUp();
            onStep?.(event);
            event.currentTarget.blur();
          } else if (onStep && (event.key === "ArrowUp" || event.key === "ArrowDown")) {
            typing.giveUp();
            onStep(event);
          }
        }}
        onKeyUp={(event) => {
          if (event.key === "ArrowUp" || event.key === "ArrowDown") onStepped?.();
        }}
      />
      {refused && (
        <span id={hint} class="number-hint" role="alert">
          Type for example {example}
        </span>
      )}
    </>
  );
}

function useTyping({ value, format, parse, onTyped }: TypedNumberProps): { typing: Typing; enter: () => void } {
  const [typing] = useState(() => new Typing());
  useEffect(() => {
    if (typing.refused.peek()) typing.giveUp(); // what was refused would hide another value
  }, [typing, value]);
  return {
    typing,
    enter: () => {
      const typed = typing.enter(parse);
      if (typed !== null && format(typed) !== format(value)) onTyped(typed);
    },
  };
}
