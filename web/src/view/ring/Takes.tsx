/** The takes of a pull, and the few keys that one is made of. */

import type { JSX } from "preact";
import { LEAST_TOLERANCE, MOST_TOLERANCE, type RingDesk } from "../../editor/ring_desk";
import type { Session } from "../../editor/session";
import { endOf, type Take } from "../../model/take";
import { formatFrame } from "../../model/time";
import { Edits } from "../controls/Edits";
import { trim } from "../numbers";

export function Takes({ desk, session }: { desk: RingDesk; session: Session }): JSX.Element | null {
  const { takes } = desk.notes.value;
  const chosen = desk.take.value;
  if (takes.length === 0) return null;
  return (
    <div class="ring-row takes" role="group" aria-label="Takes">
      <select
        aria-label="Take"
        title="The take that is drawn over the focus curve"
        value={chosen?.number.toString() ?? ""}
        onChange={({ currentTarget }) => (desk.chosen.value = Number(currentTarget.value) || null)}
      >
        <option value="">No take</option>
        {takes.map((take) => (
          <option key={take.number} value={take.number.toString()}>
            {nameOf(take, session)}
          </option>
        ))}
      </select>
      {chosen && <Chosen desk={desk} session={session} take={chosen} />}
    </div>
  );
}

function nameOf(take: Take, { shot }: Session): string {
  const seconds = take.nearness.length / shot.range.framesPerSecond;
  return `Take ${take.number}: ${formatFrame(take.start)}–${formatFrame(endOf(take))}, ${seconds.toFixed(1)} s`;
}

function Chosen({ desk, session, take }: { desk: RingDesk; session: Session; take: Take }): JSX.Element {
  return (
    <>
      <button
        type="button"
        class="button small"
        title="Throw this take away and record another one"
        disabled={desk.recorder.state.value !== "off"}
        onClick={() => {
          desk.again();
        }}
      >
        Again
      </button>
      <button
        type="button"
        class="button small"
        aria-label={`Delete take ${take.number}`}
        onClick={() => {
          desk.removeTake(take.number);
        }}
      >
        Delete
      </button>
      <Tolerance desk={desk} />
      <Outcome desk={desk} />
      <Edits session={session}>
        <button
          type="button"
          class="button small primary"
          title="Make these keys the focus of the shot, set by hand; what is before and after the take stays"
          onClick={() => void desk.apply()}
        >
          Apply
        </button>
      </Edits>
    </>
  );
}

function Tolerance({ desk }: { desk: RingDesk }): JSX.Element {
  const { tolerance } = desk;
  const text = `${trim(100 * tolerance.value, 1)} %`;
  return (
    <label class="tolerance" title="How far the keys may be off the distances of the take">
      <input
        type="range"
        class="slider"
        aria-label="Tolerance of the keys"
        aria-valuetext={text}
        min={100 * LEAST_TOLERANCE}
        max={100 * MOST_TOLERANCE}
        step={0.2}
        value={100 * tolerance.value}
        style={{ "--at": `${(100 * (tolerance.value - LEAST_TOLERANCE)) / (MOST_TOLERANCE - LEAST_TOLERANCE)}%` }}
        onInput={({ currentTarget }) => (tolerance.value = Number(currentTarget.value) / 100)}
      />
      <span class="numbers">{text}</span>
    </label>
  );
}

/** How many keys the take comes to, and how far they are off. */
function Outcome({ desk }: { desk: RingDesk }): JSX.Element | null {
  const simplified = desk.simplified.value;
  if (!simplified) return null;
  const { keys, error } = simplified;
  return (
    <span class="muted numbers outcome" role="status" data-keys={keys.length} data-error={error}>
      {keys.length} {keys.length === 1 ? "key" : "keys"}, at most {trim(100 * error, 1)} % off
    </span>
  );
}
