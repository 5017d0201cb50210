/** What is waited for, in words, with how far it is and for how long, and the button that stops it. */

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { isAsked, type Wait } from "../../editor/waits";

/** Seconds from which a wait says how long it has been. */
const LONG_S = 2;

interface WaitingProps {
  readonly wait: Wait;
  /** More of what it is than its name says. */
  readonly said?: string;
}

export function Waiting({ wait, said }: WaitingProps): JSX.Element {
  const name = wait.name.value;
  const progress = wait.progress.value;
  return (
    <span class="wait" data-wait={wait.kind}>
      {/* What goes on by itself would be read aloud all the time. */}
      <span role={isAsked(wait.kind) ? "status" : undefined}>{said ?? name}…</span>
      {progress !== null && <span class="numbers">{Math.round(100 * progress)} %</span>}
      <Elapsed key={wait.beganMs} beganMs={wait.beganMs} />
      {wait.stop && (
        <button
          type="button"
          class="button small"
          aria-label={`Stop ${name.charAt(0).toLowerCase()}${name.slice(1)}`}
          onClick={wait.stop}
        >
          Stop
        </button>
      )}
    </span>
  );
}

function Elapsed({ beganMs }: { beganMs: number }): JSX.Element | null {
  const [seconds, setSeconds] = useState(() => secondsSince(beganMs));
  useEffect(() => {
    const timer = setInterval(() => {
      setSeconds(secondsSince(beganMs));
    }, 500);
    return () => {
      clearInterval(timer);
    };
  }, [beganMs]);
  return seconds < LONG_S ? null : <span class="numbers">{seconds} s</span>;
}

function secondsSince(beganMs: number): number {
  return Math.floor((performance.now() - beganMs) / 1000);
}
