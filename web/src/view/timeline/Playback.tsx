/** How the shot plays: what part of it, what follows the last frame, and which frames are cached; and what was really shown. */

import type { ComponentChildren, JSX } from "preact";
import type { CacheFiller } from "../../editor/cache_filler";
import { MOST_BYTES } from "../../editor/frame_cache";
import type { Playhead } from "../../editor/playhead";
import type { Session } from "../../editor/session";
import { EVERY, REPEATS, type Repeat } from "../../model/playback";
import type { CacheEngine } from "../../model/quality";
import { formatFrame } from "../../model/time";
import { Menu } from "../controls/Menu";
import { TypedNumber } from "../controls/TypedNumber";
import { parseQuantity } from "../numbers";

const REPEAT_NAMES: Readonly<Record<Repeat, string>> = {
  loop: "From the first frame again",
  pingPong: "Back and forth",
  once: "Once",
};

const ENGINE_NAMES: Readonly<Record<CacheEngine, string>> = {
  lens: "drawn through the lens",
  flag: "blurred quickly (FLAG), as the lens takes too long here",
};

const MEGABYTE = 2 ** 20;

const HEAD = (
  <>
    Playback <span aria-hidden="true">▾</span>
  </>
);

export function Playback({ session }: { session: Session }): JSX.Element {
  const { playhead } = session;
  return (
    <>
      <Menu name="playback" label="Playback" placement="top-start" head={HEAD}>
        {() => (
          <div class="playback">
            <Limits playhead={playhead} />
            <Repeats playhead={playhead} />
            <Cache session={session} />
          </div>
        )}
      </Menu>
      <Rate playhead={playhead} />
    </>
  );
}

/** First and last frame that are played. */
function Limits({ playhead }: { playhead: Playhead }): JSX.Element {
  const { first, last, time } = playhead;
  const isWhole = first.value === null && last.value === null;
  const { start, end } = playhead.played.value;
  return (
    <Row label="Range">
      <Limit
        label="First frame that is played"
        time={start}
        mark={(typed) => {
          playhead.markFirst(typed);
        }}
      />
      –
      <Limit
        label="Last frame that is played"
        time={end}
        mark={(typed) => {
          playhead.markLast(typed);
        }}
      />
      <Action
        label="Play from here"
        keys="I"
        act={() => {
          playhead.markFirst(time.value);
        }}
      >
        In here
      </Action>
      <Action
        label="Play up to here"
        keys="O"
        act={() => {
          playhead.markLast(time.value);
        }}
      >
        Out here
      </Action>
      <Action
        label="Play the whole shot"
        keys="Shift I, Shift O"
        disabled={isWhole}
        act={() => {
          playhead.markFirst(null);
          playhead.markLast(null);
        }}
      >
        Whole shot
      </Action>
    </Row>
  );
}

interface LimitProps {
  readonly label: string;
  readonly time: number;
  readonly mark: (time: number) => void;
}

function Limit({ label, time, mark }: LimitProps): JSX.Element {
  return (
    <TypedNumber
      kind="frame"
      label={label}
      value={time}
      format={formatFrame}
      parse={(text) => parseQuantity(text, "")}
      example={formatFrame(time)}
      onTyped={mark}
    />
  );
}

function Repeats({ playhead }: { playhead: Playhead }): JSX.Element {
  return (
    <>
      <Row label="Repeat">
        <select
          aria-label="Repeat"
          value={playhead.repeat.value}
          onChange={({ currentTarget }) => {
            playhead.setRepeat(currentTarget.value as Repeat);
          }}
        >
          {REPEATS.map((repeat) => (
            <option key={repeat} value={repeat}>
              {REPEAT_NAMES[repeat]}
            </option>
          ))}
        </select>
      </Row>
      <Row label="Frames">
        <select
          aria-label="Frames that are played"
          value={playhead.every.value}
          onChange={({ currentTarget }) => {
            playhead.setEvery(Number(currentTarget.value));
          }}
        >
          {EVERY.map((every) => (
            <option key={every} value={every}>
              {every === 1 ? "All" : `Every ${every}${every === 2 ? "nd" : every === 3 ? "rd" : "th"}`}
            </option>
          ))}
        </select>
      </Row>
    </>
  );
}

/** What is cached of what is played, how, and in how much memory. */
function Cache({ session: { cache, filler, pictures } }: { session: Session }): JSX.Element {
  const { cached, of, missing } = filler.progress.value;
  const engine = filler.engine.value;
  const used = Math.ceil(cache.bytes.value / MEGABYTE);
  return (
    <>
      <Row label="Cached">
        <progress aria-label="Cached frames" max={of} value={cached} />
        <span class="numbers" data-reading="cached">
          {cached} of {of}
        </span>
        <Action
          label={filler.asked.value ? "Stop caching" : "Cache all frames of the range now"}
          disabled={pictures.refusal !== null || (missing === 0 && !filler.asked.value)}
          act={() => {
            filler.ask(!filler.asked.value);
          }}
        >
          {filler.asked.value ? "Stop" : "Cache range"}
        </Action>
        <Action
          label="Forget the cached frames"
          disabled={cache.bytes.value === 0}
          act={() => {
            filler.clear();
          }}
        >
          Clear
        </Action>
      </Row>
      <p class="muted" role="status">
        {stateOf(filler)} {used} of {MOST_BYTES / MEGABYTE} MB{engine && `; ${ENGINE_NAMES[engine]}`}.
      </p>
    </>
  );
}

function stateOf({ making, isFull, progress }: CacheFiller): string {
  if (making.value !== null) return `Caching frame ${formatFrame(making.value)}…`;
  if (isFull.value) return "The memory is full: play a shorter range.";
  return progress.value.missing === 0 ? "All frames are cached." : "Frames are cached while nothing else is wanted.";
}

/** Rate and dropped frames of the playing. */
function Rate({ playhead }: { playhead: Playhead }): JSX.Element | null {
  const { rate, dropped } = playhead.seen.value;
  if (!playhead.playing.value) return null;
  const wanted = playhead.range.framesPerSecond * Math.abs(playhead.speed.value);
  const isSlow = rate !== null && rate < 0.95 * (wanted / playhead.every.value);
  const speed = playhead.speed.value === 1 ? "" : ` · ${playhead.speed.value}×`.replace("-", "−");
  return (
    <span
      class={isSlow ? "rate numbers slow" : "rate numbers"}
      title="Frames shown in a second, and frames that were dropped"
    >
      <b data-reading="rate">{rate === null ? "–" : rate.toFixed(1)}</b> fps · <b data-reading="dropped">{dropped}</b>{" "}
      dropped
      {speed}
    </span>
  );
}

function Row({ label, children }: { label: string; children: ComponentChildren }): JSX.Element {
  return (
    <div class="playback-row">
      <span class="muted">{label}</span>
      {children}
    </div>
  );
}

interface ActionProps {
  readonly label: string;
  readonly keys?: string;
  readonly disabled?: boolean;
  readonly act: () => void;
  readonly children: string;
}

function Action({ label, keys, disabled = false, act, children }: ActionProps): JSX.Element {
  return (
    <button
      type="button"
      class="button small"
      title={keys === undefined ? label : `${label} (${keys})`}
      disabled={disabled}
      onClick={act}
    >
      {children}
    </button>
  );
}
