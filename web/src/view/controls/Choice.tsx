/** A choice among few or many, with its label beside it. */

import type { ComponentChildren, JSX } from "preact";

interface ChoiceProps {
  readonly label: string;
  readonly value: string;
  readonly onChoose: (value: string) => void;
  readonly hint?: string | undefined;
  readonly disabled?: boolean;
  /** Its options. */
  readonly children: ComponentChildren;
}

export function Choice({ label, value, onChoose, hint, disabled = false, children }: ChoiceProps): JSX.Element {
  return (
    <label class="choice" title={hint}>
      <span>{label}</span>
      <select
        value={value}
        disabled={disabled}
        onChange={(event) => {
          onChoose(event.currentTarget.value);
        }}
      >
        {children}
      </select>
    </label>
  );
}

export function Options({
  values,
  names,
}: {
  values: readonly string[];
  names?: Readonly<Record<string, string>>;
}): JSX.Element {
  return (
    <>
      {values.map((value) => (
        <option key={value} value={value}>
          {names?.[value] ?? value}
        </option>
      ))}
    </>
  );
}
