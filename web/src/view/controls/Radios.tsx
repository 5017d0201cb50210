/** A few values of which one is chosen, as buttons in a row. */

import type { JSX } from "preact";

interface RadiosProps<Value extends string> {
  readonly label: string;
  readonly values: readonly Value[];
  readonly value: Value | null;
  readonly names: Readonly<Record<Value, string>>;
  readonly titles?: Readonly<Record<Value, string>>;
  readonly isDisabled?: (value: Value) => boolean;
  /** Class of the row, beside that of all rows. */
  readonly kind?: string;
  readonly isLarge?: boolean;
  /** Setting that the row stands for. */
  readonly setting?: string;
  readonly onChoose: (value: Value) => void;
}

export function Radios<Value extends string>(props: RadiosProps<Value>): JSX.Element {
  const { label, values, value, names, titles, isDisabled, kind, isLarge = false, setting, onChoose } = props;
  return (
    <div class={kind ? `group ${kind}` : "group"} role="radiogroup" aria-label={label} data-setting={setting}>
      {values.map((choice) => (
        <button
          key={choice}
          type="button"
          class={isLarge ? "button" : "button small"}
          role="radio"
          aria-checked={value === choice}
          title={titles?.[choice]}
          disabled={isDisabled?.(choice)}
          onClick={() => {
            onChoose(choice);
          }}
        >
          {names[choice]}
        </button>
      ))}
    </div>
  );
}
