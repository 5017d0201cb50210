/** Values of which any are chosen, as buttons that stay pressed. */

import type { JSX } from "preact";
import type { NameSet } from "../../editor/name_set";

interface TogglesProps<Value extends string> {
  readonly label: string;
  readonly values: readonly Value[];
  /** What the buttons say, where that is not the value itself. */
  readonly names?: Readonly<Record<Value, string>>;
  readonly chosen: NameSet;
}

export function Toggles<Value extends string>({ label, values, names, chosen }: TogglesProps<Value>): JSX.Element {
  return (
    <div class="toggles" role="group" aria-label={label}>
      {values.map((value) => (
        <button
          key={value}
          type="button"
          class="button small"
          aria-pressed={chosen.has(value)}
          onClick={() => {
            chosen.toggle(value);
          }}
        >
          {names?.[value] ?? value}
        </button>
      ))}
    </div>
  );
}
