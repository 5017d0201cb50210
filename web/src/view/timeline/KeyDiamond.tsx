/** A diamond, as in animation tools: hollow where nothing is keyed, filled where this frame has a key. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { useChosen } from "../controls/chosen";

interface KeyDiamondProps {
  readonly session: Session;
  /** Which key, read aloud. */
  readonly label: string;
  /** Name of the keyed setting. */
  readonly what: string;
  /** Whether there are keys at any time. */
  readonly keyed: boolean;
  /** Whether there is one at this frame. */
  readonly now: boolean;
  /** Whether `keyed` and `now` are what the service has now, so that what is set need not stand in for them. */
  readonly fresh: boolean;
  readonly shortcut?: string;
  /** Sets or removes the key; resolves once that is done. */
  readonly onToggle: () => Promise<unknown>;
}

export function KeyDiamond(props: KeyDiamondProps): JSX.Element {
  const { session, label, what, keyed, fresh, shortcut = "", onToggle } = props;
  const time = session.playhead.time.value;
  const [now, chosen] = useChosen(props.now, fresh, time);
  return (
    <button
      type="button"
      class={`key${keyed || now ? " keyed" : ""}`}
      aria-pressed={now}
      aria-label={`Key of ${label}`}
      title={`${now ? "Remove the key" : "Set a key"} of ${what} at this frame${shortcut}`}
      onClick={() => {
        chosen.choose(!now, onToggle(), time);
      }}
    >
      <svg viewBox="-6 -6 12 12" width="12" height="12" aria-hidden="true">
        <path d="M0 -4.5L4.5 0L0 4.5L-4.5 0Z" />
      </svg>
    </button>
  );
}
