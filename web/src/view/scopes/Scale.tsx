/** The percent scale of a scope: its marks lie along it, from 0 to 1. */

import type { JSX } from "preact";

const MARKS = [0, 25, 50, 75, 100] as const;

export function Scale(): JSX.Element {
  return (
    <div class="scope-scale numbers" aria-hidden="true">
      {MARKS.map((mark) => (
        <span key={mark} style={{ "--at": mark / 100 }}>
          {mark}
        </span>
      ))}
    </div>
  );
}
