/** What a click on the picture means; right after one, it changes that one. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { MOST_FRAMES } from "../../editor/pulls";
import type { PullSpan, Reach } from "../../model/pull";
import { EASES, type Ease } from "../../model/shot";
import { formatFrame } from "../../model/time";
import { TypedNumber } from "../controls/TypedNumber";
import { parseQuantity } from "../numbers";
import { Options } from "../controls/Choice";

const REACH_NAMES: Readonly<Record<Reach, string>> = {
  from: "from here on",
  shot: "for the whole shot",
  frame: "at this frame",
};
const EASE_NAMES: Readonly<Record<Ease, string>> = {
  smooth: "smoothly",
  in: "starting softly",
  out: "ending softly",
  linear: "evenly",
};

export function PullChoice({ session }: { session: Session }): JSX.Element {
  const { pulls } = session;
  const { reach, frames, ease } = pulls.choice;
  const [last, span] = [pulls.last.value, pulls.span.value];
  return (
    <span class="pull-choice" role="group" aria-label="What a click means">
      <span role="status">
        {last && (
          <>
            Focus on <b>{last.name}</b>
            {span && <span class="visually-hidden">{sayTimes(span)}</span>}
          </>
        )}
      </span>
      <select
        aria-label="For how long"
        value={reach.value}
        onChange={({ currentTarget }) => void pulls.change({ reach: currentTarget.value as Reach })}
      >
        <Options values={Object.keys(REACH_NAMES)} names={REACH_NAMES} />
      </select>
      {reach.value === "from" && (
        <>
          <TypedNumber
            kind="frame"
            label="Length of the pull"
            value={frames.value}
            format={formatFrame}
            parse={(text) => {
              const typed = parseQuantity(text, "");
              return typed !== null && typed >= 1 && typed <= MOST_FRAMES ? typed : null;
            }}
            example="12"
            onTyped={(typed) => {
              void pulls.change({ frames: typed });
            }}
          />
          <span>frames,</span>
          <select
            aria-label="Ease"
            value={ease.value}
            onChange={({ currentTarget }) => void pulls.change({ ease: currentTarget.value as Ease })}
          >
            <Options values={EASES} names={EASE_NAMES} />
          </select>
        </>
      )}
    </span>
  );
}

/** The times of a pull, which the scrubber shows, in words. */
function sayTimes({ start, arrival, held }: PullSpan): string {
  const over = start < arrival ? `, from frame ${formatFrame(start)}, there at ${formatFrame(arrival)}` : "";
  if (held === null) return `${over}, to the end of the shot`;
  return held > arrival
    ? `${over}, until frame ${formatFrame(held)}`
    : `${over}, at frame ${formatFrame(arrival)} alone`;
}
