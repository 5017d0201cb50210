/** The focus ring of the lens, and what is recorded of it. */

import type { JSX } from "preact";
import type { RingDesk } from "../../editor/ring_desk";
import type { Session } from "../../editor/session";
import type { LengthUnit } from "../../model/distance";
import { MOST_MARKS } from "../../model/take";
import { controlOf } from "../own_keys";
import { RecordBar } from "./RecordBar";
import { RingDial } from "./RingDial";
import { Takes } from "./Takes";

interface RingPanelProps {
  readonly session: Session;
  readonly unit: LengthUnit;
}

export function RingPanel({ session, unit }: RingPanelProps): JSX.Element | null {
  const { desk } = session;
  if (desk.choices.shown.value === "off") return null;
  const ring = desk.ring.scale.value;
  return (
    <section
      class="ring-panel"
      aria-label="Focus ring and takes"
      onKeyDown={(event) => {
        if (markByKey(desk, event)) event.preventDefault();
      }}
    >
      {ring ? (
        <>
          <RingDial desk={desk} ring={ring} unit={unit} />
          <div class="ring-controls">
            <RecordBar desk={desk} session={session} ring={ring} unit={unit} />
            <Takes desk={desk} session={session} />
          </div>
        </>
      ) : (
        <p class="muted pad-all">{desk.refusal}</p>
      )}
    </section>
  );
}

/** Sets the mark of a digit, and with Shift removes it. */
function markByKey(desk: RingDesk, event: KeyboardEvent): boolean {
  const number = Number(/^Digit([1-9])$/.exec(event.code)?.[1] ?? 0);
  const isTyped = event.target instanceof Element && ["text", "select"].includes(controlOf(event.target) ?? "");
  if (number < 1 || number > MOST_MARKS || isTyped || event.ctrlKey || event.metaKey || event.altKey) return false;
  if (event.shiftKey) desk.removeMark(number);
  else desk.setMark(number);
  return true;
}
