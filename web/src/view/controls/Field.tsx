/** One number of the lens: typed, or dragged on a slider. A drag, or a held key, is one edit. */

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Drag } from "../../editor/drag";
import type { Scale } from "../../model/scale";
import { TypedNumber } from "./TypedNumber";

/** A way to show and type a number. */
export interface Typed {
  readonly label: string;
  readonly format: (value: number) => string;
  readonly parse: (text: string) => number | null;
  /** Example of a value, shown with one that cannot be read. */
  readonly example: string;
}

/** A mark along a slider. */
export interface Mark {
  /** 0 to 1. */
  readonly at: number;
  /** Null for a small one. */
  readonly text: string | null;
}

export interface FieldProps extends Typed {
  readonly value: number;
  readonly scale: Scale;
  /** What the label says on the page, where that is something else. */
  readonly shown?: string;
  /** Another way to show and type the same number. */
  readonly also?: Typed;
  /** Marks below the slider, which then has a line of its own. */
  readonly marks?: readonly Mark[];
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
  const { label, scale, format, parse, example, shown = label, also, marks, disabled = false } = props;
  const { value, move, commit, cancel } = useDrag(props);
  // While Alt is held there are no detents.
  const scaleFor = ({ altKey }: { readonly altKey: boolean }): Scale => (altKey ? (scale.free ?? scale) : scale);
  const dragged = useRef(scale);
  const position = scale.toPosition(value) * TRAVEL;
  const step = (event: KeyboardEvent): void => {
    const count = KEY_STEPS[event.key];
    if (count !== undefined) {
      event.preventDefault();
      move(scaleFor(event).step(value, count));
    } else if (event.key === "Escape" && cancel()) event.preventDefault();
  };
  const typed = { value, disabled, onTyped: commit, onStep: step, onStepped: commit };
  return (
    <div class={marks ? "field marked" : "field"} title={props.hint}>
      <span class={props.labelHidden ? "field-label hidden" : "field-label"} aria-hidden="true">
        {shown}
      </span>
      <span class="typed">
        <TypedNumber {...typed} label={label} format={format} parse={parse} example={example} />
        {also && <TypedNumber {...typed} {...also} />}
      </span>
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
          move(dragged.current.toValue(event.currentTarget.valueAsNumber / TRAVEL));
        }}
        onPointerDown={(event) => (dragged.current = scaleFor(event))}
        onPointerMove={(event) => (dragged.current = scaleFor(event))}
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
      {marks && <Marks marks={marks} />}
    </div>
  );
}

function Marks({ marks }: { marks: readonly Mark[] }): JSX.Element {
  return (
    <span class="marks" aria-hidden="true">
      {marks.map(({ at, text }) => (
        <span key={at} class={text === null ? "minor" : ""} style={{ left: `${(100 * at).toFixed(2)}%` }}>
          {text}
        </span>
      ))}
    </span>
  );
}

/** The value while it is dragged, and until the service has it too. */
function useDrag({ value, fresh, startDrag }: FieldProps): {
  value: number;
  move: (value: number) => void;
  commit: (value?: number) => void;
  /** Gives a drag up; returns whether there was one. */
  cancel: () => boolean;
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
      const hadOne = drag.current !== null;
      givenUp.current = hadOne;
      drag.current?.cancel();
      drag.current = null;
      setDraft(null);
      return hadOne;
    },
  };
}
