/** A number with its name, as in a table of readings; not for setting. */

import type { JSX } from "preact";

interface ReadingProps {
  readonly name: string;
  readonly value: string;
  /** What read it. */
  readonly of: "reading" | "meter";
}

export function Reading({ name, value, of }: ReadingProps): JSX.Element {
  return (
    <div>
      <dt>{name}</dt>
      <dd {...{ [`data-${of}`]: name.toLowerCase() }}>{value}</dd>
    </div>
  );
}
