/** Recording of the ring, where it begins and ends, and the marks. */

import type { JSX } from "preact";
import { SPEEDS } from "../../editor/recorder";
import type { RingDesk } from "../../editor/ring_desk";
import type { Session } from "../../editor/session";
import { formatDistance, type LengthUnit } from "../../model/distance";
import { saidFrom, turnAt, type Ring } from "../../model/ring";
import { formatFrame } from "../../model/time";
import { TypedNumber } from "../controls/TypedNumber";
import { parseQuantity } from "../numbers";
import { RingMenu } from "./RingMenu";

interface RecordBarProps {
  readonly desk: RingDesk;
  readonly session: Session;
  readonly ring: Ring;
  readonly unit: LengthUnit;
}

const STATE_NAMES = { off: "", armed: "Turn the ring to begin", recording: "Recording" } as const;

export function RecordBar({ desk, session, ring, unit }: RecordBarProps): JSX.Element {
  const state = desk.recorder.state.value;
  const { punchIn } = desk.notes.value;
  const waits = punchIn === null ? STATE_NAMES.armed : `Records from frame ${formatFrame(punchIn)} on`;
  return (
    <div class="ring-row" role="group" aria-label="Recording">
      <button
        type="button"
        class={`button record ${state}`}
        aria-pressed={state !== "off"}
        title={state === "off" ? "Play, and record the ring (Shift W)" : "End the recording (Shift W)"}
        onClick={() => {
          desk.record();
        }}
      >
        <i aria-hidden="true" /> {state === "off" ? "Record" : "Stop"}
      </button>
      <select
        class="speed"
        aria-label="Speed of the recording"
        title="How fast the shot plays while it is recorded"
        value={desk.recorder.speed.value.toString()}
        onChange={({ currentTarget }) => (desk.recorder.speed.value = Number(currentTarget.value))}
      >
        {SPEEDS.map((speed) => (
          <option key={speed} value={speed.toString()}>
            {speed} ×
          </option>
        ))}
      </select>
      <Punch desk={desk} session={session} name="punchIn" label="In" title="Punch in at this frame (Alt Shift I)" />
      <Punch desk={desk} session={session} name="punchOut" label="Out" title="Punch out at this frame (Alt Shift O)" />
      <MarkButtons desk={desk} ring={ring} unit={unit} />
      <RingMenu desk={desk} />
      <span class="muted ring-state" role="status">
        {state === "armed" ? waits : STATE_NAMES[state]}
      </span>
    </div>
  );
}

interface PunchProps {
  readonly desk: RingDesk;
  readonly session: Session;
  readonly name: "punchIn" | "punchOut";
  readonly label: string;
  readonly title: string;
}

/** A frame at which recording begins or ends; none where nothing stands there. */
function Punch({ desk, session, name, label, title }: PunchProps): JSX.Element {
  const frame = desk.notes.value[name];
  return (
    <span class="group punch">
      <button
        type="button"
        class="button small"
        aria-label={title.replace(/ \(.*/, "")}
        title={title}
        onClick={() => {
          desk.punch({ [name]: session.playhead.time.value });
        }}
      >
        {label}
      </button>
      <TypedNumber
        kind="frame"
        label={name === "punchIn" ? "Punch-in frame" : "Punch-out frame"}
        value={frame ?? NaN}
        format={(time) => (Number.isNaN(time) ? "–" : formatFrame(time))}
        parse={(text) => (/^[–-]?$/.test(text.trim()) ? NaN : parseQuantity(text, ""))}
        example={`${formatFrame(session.shot.range.start)}, or nothing for none`}
        onTyped={(time) => {
          desk.punch({ [name]: Number.isNaN(time) ? null : time });
        }}
      />
    </span>
  );
}

function MarkButtons({ desk, ring, unit }: { desk: RingDesk; ring: Ring; unit: LengthUnit }): JSX.Element {
  const origin = desk.choices.origin.value;
  return (
    <div class="group ring-marks" role="group" aria-label="Witness marks">
      <button
        type="button"
        class="button small"
        title="Set a mark at the present distance (1 to 9 on the ring; Shift and the digit removes it)"
        onClick={() => {
          desk.setMark();
        }}
      >
        Mark
      </button>
      {desk.notes.value.marks.map(
        (distanceM, at) =>
          distanceM !== null && (
            <button
              key={at}
              type="button"
              class="button small"
              aria-label={`Turn to mark ${at + 1}`}
              title={`Mark ${at + 1}, ${formatDistance(saidFrom(origin, ring, distanceM), unit)}: turn to it, or with Shift remove it`}
              onClick={({ shiftKey }) => {
                if (shiftKey) desk.removeMark(at + 1);
                else desk.ring.easeTo(turnAt(ring, distanceM));
              }}
            >
              {at + 1}
            </button>
          ),
      )}
    </div>
  );
}
