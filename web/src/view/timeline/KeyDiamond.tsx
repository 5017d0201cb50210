/** A diamond, as in animation tools: hollow where nothing is keyed, filled where this frame has a key. */

import type { JSX } from "preact";

interface KeyDiamondProps {
  /** Which key, read aloud. */
  readonly label: string;
  /** Name of the keyed setting. */
  readonly what: string;
  /** Whether there are keys at any time. */
  readonly keyed: boolean;
  /** Whether there is one at this frame. */
  readonly now: boolean;
  readonly shortcut?: string;
  readonly onToggle: () => void;
}

export function KeyDiamond({ label, what, keyed, now, shortcut = "", onToggle }: KeyDiamondProps): JSX.Element {
  return (
    <button
      type="button"
      class={`key${keyed ? " keyed" : ""}`}
      aria-pressed={now}
      aria-label={`Key of ${label}`}
      title={`${now ? "Remove the key" : "Set a key"} of ${what} at this frame${shortcut}`}
      onClick={onToggle}
    >
      <svg viewBox="-6 -6 12 12" width="12" height="12" aria-hidden="true">
        <path d="M0 -4.5L4.5 0L0 4.5L-4.5 0Z" />
      </svg>
    </button>
  );
}
