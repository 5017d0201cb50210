/** Play, step, and say which frame it is. */

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import type { Session } from "../../editor/session";
import { formatDistance, type LengthUnit } from "../../model/distance";
import { formatFrame } from "../../model/time";
import { Icon, type IconName } from "../icons";

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
        label="One frame on"
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
      <FrameNumber
        time={time}
        onTyped={(typed) => {
          playhead.goTo(typed);
        }}
      />
      <span class="muted numbers">
        of {formatFrame(range.start)}–{formatFrame(range.end)} · {seconds.toFixed(2)} s ·{" "}
        {Number(range.framesPerSecond.toFixed(3))} fps
      </span>
      <div class="spacer" />
      <Legend session={session} unit={unit} />
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

function FrameNumber({ time, onTyped }: { time: number; onTyped: (time: number) => void }): JSX.Element {
  const [text, setText] = useState<string | null>(null);
  const finish = (): void => {
    const typed = text?.trim() ?? "";
    setText(null);
    if (typed !== "" && Number.isFinite(Number(typed))) onTyped(Number(typed));
  };
  return (
    <input
      type="text"
      class="number frame"
      inputMode="numeric"
      aria-label="Frame"
      value={text ?? formatFrame(time)}
      onFocus={(event) => {
        event.currentTarget.select();
      }}
      onInput={(event) => {
        setText(event.currentTarget.value);
      }}
      onBlur={finish}
      onKeyDown={(event) => {
        if (event.key === "Enter") event.currentTarget.blur();
        else if (event.key === "Escape") {
          setText(null);
          event.currentTarget.blur();
        }
      }}
    />
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
