/** Play, step, and say which frame it is. */

import type { JSX } from "preact";
import type { Playhead } from "../../editor/playhead";
import type { Session } from "../../editor/session";
import { formatDistance, type LengthUnit } from "../../model/distance";
import { formatFrame } from "../../model/time";
import { MOST_BENT } from "../../model/correction";
import { Edits } from "../controls/Edits";
import { TypedNumber } from "../controls/TypedNumber";
import { Icon, type IconName } from "../icons";
import { parseQuantity } from "../numbers";
import { KeyBar } from "./KeyBar";
import { Playback } from "./Playback";

export function Transport({ session, unit }: { session: Session; unit: LengthUnit }): JSX.Element {
  const { playhead } = session;
  const { range } = playhead;
  const playing = playhead.playing.value;
  const time = playhead.time.value;
  const seconds = (time - range.start) / range.framesPerSecond;
  return (
    <div class="transport" role="toolbar" aria-label="Transport">
      <TransportButton
        icon="first"
        label="First frame"
        keys="Home"
        act={() => {
          playhead.goTo(range.start);
        }}
      />
      <TransportButton
        icon="back"
        label="One frame back"
        keys="←"
        act={() => {
          playhead.step(-1);
        }}
      />
      <TransportButton
        icon={playing ? "pause" : "play"}
        label={playing ? "Pause" : "Play"}
        keys="Space"
        act={() => {
          playhead.toggle();
        }}
      />
      <TransportButton
        icon="on"
        label="One frame forward"
        keys="→"
        act={() => {
          playhead.step(1);
        }}
      />
      <TransportButton
        icon="last"
        label="Last frame"
        keys="End"
        act={() => {
          playhead.goTo(range.end);
        }}
      />
      <FrameNumber playhead={playhead} />
      <span class="muted numbers shot-length">
        of {formatFrame(range.start)}–{formatFrame(range.end)} · {seconds.toFixed(2)} s ·{" "}
        {Number(range.framesPerSecond.toFixed(3))} fps
      </span>
      <Playback session={session} />
      <RingButton session={session} />
      <CurveChoice session={session} />
      <WholeShot session={session} />
      <TouchKeys session={session} />
      <div class="spacer" />
      <Reading session={session} unit={unit} />
    </div>
  );
}

function FrameNumber({ playhead }: { playhead: Playhead }): JSX.Element {
  return (
    <TypedNumber
      kind="frame"
      label="Frame"
      value={playhead.time.value}
      format={formatFrame}
      parse={(text) => parseQuantity(text, "")}
      example={formatFrame(playhead.range.end)}
      onTyped={(typed) => {
        playhead.goTo(typed);
      }}
    />
  );
}

function RingButton({ session }: { session: Session }): JSX.Element {
  const { shown } = session.desk.choices;
  return (
    <button
      type="button"
      class="button icon-only"
      aria-pressed={shown.value === "on"}
      aria-label="Focus ring"
      title="Focus ring, and record a pull of it (W)"
      onClick={() => (shown.value = shown.value === "on" ? "off" : "on")}
    >
      <Icon name="ring" />
    </button>
  );
}

/** Which curve is drawn: where the focus is, or a value that has keys. */
function CurveChoice({ session }: { session: Session }): JSX.Element | null {
  const { keys } = session;
  const curves = keys.curves.value;
  if (curves.length === 0) return null;
  return (
    <select
      class="curve-choice"
      aria-label="Curve"
      title="The curve that is drawn below"
      value={keys.graph.value?.saved.id ?? ""}
      onChange={({ currentTarget }) => {
        keys.graphed.value = currentTarget.value || null;
      }}
    >
      <option value="">Focus curve</option>
      {curves.map(({ id, label }) => (
        <option key={id} value={id}>
          {label}
        </option>
      ))}
    </select>
  );
}

/** Shows the whole shot again, where the timeline shows a part of it. */
function WholeShot({ session: { timeView } }: { session: Session }): JSX.Element | null {
  if (timeView.isWhole.value) return null;
  return (
    <button
      type="button"
      class="button small"
      title="Show the whole shot (F in the timeline, with no keys selected)"
      onClick={() => {
        timeView.frame([]);
      }}
    >
      Whole shot
    </button>
  );
}

/** For fingers, which have no Shift, no Alt and no wheel. */
function TouchKeys({ session: { touch, timeView } }: { session: Session }): JSX.Element {
  const { several, free } = touch;
  return (
    <div class="group touch-keys" role="group" aria-label="Keys by touch">
      <button
        type="button"
        class="button"
        aria-pressed={several.value}
        title="A touch selects one more key, or one fewer"
        onClick={() => (several.value = !several.value)}
      >
        Several
      </button>
      <button
        type="button"
        class="button"
        aria-pressed={free.value}
        title="Keys are dragged without snapping, and handles turn alone"
        onClick={() => (free.value = !free.value)}
      >
        Free
      </button>
      <button
        type="button"
        class="button"
        aria-label="Show less of the time"
        onClick={() => {
          timeView.zoomIn();
        }}
      >
        +
      </button>
      <button
        type="button"
        class="button"
        aria-label="Show more of the time"
        onClick={() => {
          timeView.zoomOut();
        }}
      >
        −
      </button>
    </div>
  );
}

interface TransportButtonProps {
  readonly icon: IconName;
  readonly label: string;
  readonly keys: string;
  readonly act: () => void;
}

function TransportButton({ icon, label, keys, act }: TransportButtonProps): JSX.Element {
  return (
    <button type="button" class="button icon-only" aria-label={label} title={`${label} (${keys})`} onClick={act}>
      <Icon name={icon} />
    </button>
  );
}

/** The selected keys; else what the last edit has corrected; else where the focus is. */
function Reading({ session, unit }: { session: Session; unit: LengthUnit }): JSX.Element {
  if (session.keys.selectedStacks.value.length > 0) return <KeyBar session={session} unit={unit} />;
  const { last } = session.corrections;
  if (last.value) return <CorrectionBar session={session} label={last.value.label} time={last.value.time} />;
  return <Legend session={session} unit={unit} />;
}

/** How widely a value that was set on a dense curve has bent it. */
function CorrectionBar({ session, label, time }: { session: Session; label: string; time: number }): JSX.Element {
  const { corrections } = session;
  return (
    <div class="key-bar" role="group" aria-label="Correction">
      <Edits session={session}>
        <span class="muted" role="status">
          The {label} is bent around frame {formatFrame(time)}; frames to each side:
        </span>
        <TypedNumber
          kind="frame"
          label="Frames that are bent to each side"
          value={corrections.width.value}
          format={formatFrame}
          parse={(text) => {
            const frames = parseQuantity(text, "");
            return frames !== null && frames >= 1 && frames <= MOST_BENT ? frames : null;
          }}
          example="12"
          onTyped={(frames) => {
            void corrections.widen(frames);
          }}
        />
      </Edits>
    </div>
  );
}

function Legend({ session, unit }: { session: Session; unit: LengthUnit }): JSX.Element | null {
  const readout = session.document.readout.value;
  if (!readout) return null;
  return (
    <span class="legend numbers">
      <i class="swatch-line" /> Focus <b data-reading="focus">{formatDistance(readout.focusDistanceM, unit)}</b>
      <i class="swatch-band" /> Depth of field{" "}
      <b>
        {formatDistance(readout.nearM, unit)} – {formatDistance(readout.farM, unit)}
      </b>
    </span>
  );
}
