/** One number of the lens: typed, or dragged on a slider. A drag, or a held key, is one edit. */

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Drag } from "../../editor/document";
import type { Scale } from "../../model/scale";
import { TypedNumber } from "./TypedNumber";

export interface FieldProps {
  readonly label: string;
  readonly value: number;
  readonly scale: Scale;
  readonly format: (value: number) => string;
  readonly parse: (text: string) => number | null;
  /** Example of a value, shown with one that cannot be read. */
  readonly example: string;
  readonly startDrag: () => Drag<number>;
  /** Whether `value` is what the service has now, so that a dragged value need not stand in for it. */
  readonly fresh: boolean;
  /** Says nothing on the page but is read aloud. */
  readonly labelHidden?: boolean;
  readonly disabled?: boolean;
  /** More of what it is, on hover. */
  readonly hint?: string;
}

const TRAVEL = 1000;
const KEY_STEPS: Readonly<Record<string, number>> = {
  ArrowUp: 1,
  ArrowRight: 1,
  ArrowDown: -1,
  ArrowLeft: -1,
  PageUp: 5,
  PageDown: -5,
};

export function Field(props: FieldProps): JSX.Element {
  const { label, scale, format, parse, example, disabled = false } = props;
  const { value, move, commit, cancel } = useDrag(props);
  const position = scale.toPosition(value) * TRAVEL;
  const step = (event: KeyboardEvent): void => {
    const count = KEY_STEPS[event.key];
    if (count !== undefined) {
      event.preventDefault();
      move(scale.step(value, count));
    } else if (event.key === "Escape") cancel();
  };
  return (
    <div class="field" title={props.hint}>
      <span class={props.labelHidden ? "field-label hidden" : "field-label"} aria-hidden="true">
        {label}
      </span>
      <TypedNumber
        label={label}
        value={value}
        format={format}
        parse={parse}
        example={example}
        disabled={disabled}
        onTyped={commit}
        onStep={step}
        onStepped={commit}
      />
      <input
        type="range"
        class="slider"
        min={0}
        max={TRAVEL}
        step={1}
        value={position}
        disabled={disabled}
        style={{ "--at": `${(position / TRAVEL) * 100}%` }}
        aria-label={label}
        aria-valuetext={format(value)}
        onInput={(event) => {
          move(scale.toValue(event.currentTarget.valueAsNumber / TRAVEL));
        }}
        onChange={() => {
          commit();
        }}
        onKeyDown={step}
        onKeyUp={(event) => {
          if (event.key in KEY_STEPS) commit();
        }}
        onBlur={() => {
          commit();
        }}
      />
    </div>
  );
}

/** The value while it is dragged, and until the service has it too. */
function useDrag({ value, fresh, startDrag }: FieldProps): {
  value: number;
  move: (value: number) => void;
  commit: (value?: number) => void;
  cancel: () => void;
} {
  const drag = useRef<Drag<number> | null>(null);
  // The last value that was moved to, which may not have been rendered yet.
  const last = useRef(value);
  // After Escape the pointer may still be down: until it is let go, nothing moves.
  const givenUp = useRef(false);
  const [draft, setDraft] = useState<number | null>(null);
  useEffect(() => {
    if (fresh && !drag.current) setDraft(null);
  }, [fresh, value]);
  return {
    value: draft ?? value,
    move: (next) => {
      if (givenUp.current) return;
      drag.current ??= startDrag();
      setDraft(next);
      last.current = next;
      drag.current.move(next);
    },
    commit: (typed) => {
      givenUp.current = false;
      if (typed === undefined && !drag.current) return;
      const next = typed ?? last.current;
      setDraft(next);
      (drag.current ?? startDrag()).commit(next);
      drag.current = null;
    },
    cancel: () => {
      givenUp.current = drag.current !== null;
      drag.current?.cancel();
      drag.current = null;
      setDraft(null);
    },
  };
}
