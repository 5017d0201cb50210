/** The frames in a row: drag to scrub, or use the arrow keys. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { formatFrame, frameTicks } from "../../model/time";
import { OtherFlags } from "../company/OtherFlags";
import { NoteFlags } from "../notes/NoteFlags";
import type { TimeAxis } from "./time_axis";

const HEIGHT_PX = 26;

interface ScrubberProps {
  readonly session: Session;
  readonly axis: TimeAxis;
  readonly onScrub: (down: PointerEvent) => void;
}

export function Scrubber({ session, axis, onScrub }: ScrubberProps): JSX.Element {
  const { range } = axis;
  const { playhead } = session;
  const time = playhead.time.value;
  const major = frameTicks({ ...range, ...axis.span }, (axis.right - axis.left) / 70);
  return (
    <div
      class="scrubber"
      role="slider"
      tabIndex={0}
      aria-label="Frame"
      aria-orientation="horizontal"
      aria-valuemin={range.start}
      aria-valuemax={range.end}
      aria-valuenow={time}
      aria-valuetext={`Frame ${formatFrame(time)}`}
      onPointerDown={onScrub}
      onKeyDown={(event) => {
        if (scrubKey(session, event)) event.preventDefault();
      }}
    >
      <svg width={axis.width} height={HEIGHT_PX} aria-hidden="true">
        <rect class="scrub-bed" x={axis.left} y={0} width={axis.right - axis.left} height={HEIGHT_PX} />
        <Outside session={session} axis={axis} />
        <PullTimes session={session} axis={axis} />
        <MinorTicks axis={axis} />
        {major.map((tick) => (
          <g key={tick} transform={`translate(${axis.x(tick)} 0)`}>
            <line y1={HEIGHT_PX - 9} y2={HEIGHT_PX} />
            <text y={12} text-anchor="middle">
              {formatFrame(tick)}
            </text>
          </g>
        ))}
        <KeptFrames session={session} axis={axis} />
        <NoteFlags session={session} axis={axis} />
        <OtherFlags session={session} axis={axis} />
        {axis.has(time) && (
          <g class="scrub-head" transform={`translate(${axis.x(time)} 0)`}>
            <path d={`M-5 0H5V${HEIGHT_PX - 12}L0 ${HEIGHT_PX - 6}L-5 ${HEIGHT_PX - 12}Z`} />
          </g>
        )}
      </svg>
    </div>
  );
}

function scrubKey(session: Session, event: KeyboardEvent): boolean {
  const { playhead } = session;
  const step = event.shiftKey ? 10 : 1;
  if (event.key === "ArrowLeft" || event.key === "ArrowDown") playhead.step(-step);
  else if (event.key === "ArrowRight" || event.key === "ArrowUp") playhead.step(step);
  else if (event.key === "PageDown") playhead.step(-10);
  else if (event.key === "PageUp") playhead.step(10);
  else if (event.key === "Home") playhead.goTo(playhead.range.start);
  else if (event.key === "End") playhead.goTo(playhead.range.end);
  else return false;
  return true;
}

/** A tick for each frame, where there is room. */
function MinorTicks({ axis }: { axis: TimeAxis }): JSX.Element | null {
  if (axis.perFrame < 5) return null;
  const xs: number[] = [];
  const { range, span } = axis;
  const first = range.start + Math.ceil(span.start - range.start - 1e-6);
  for (let time = first; time <= span.end + 1e-6; time += 1) xs.push(axis.x(time));
  return <path class="minor" d={xs.map((x) => `M${x.toFixed(1)} ${HEIGHT_PX - 4}V${HEIGHT_PX}`).join("")} />;
}

/** What is not played. */
function Outside({ session, axis }: { session: Session; axis: TimeAxis }): JSX.Element {
  const { start, end } = session.playhead.played.value;
  const within = (time: number): number => Math.min(Math.max(axis.x(time), axis.left), axis.right);
  const [from, to] = [within(start), within(end)];
  return (
    <>
      <rect class="not-played" x={axis.left} y={0} width={from - axis.left} height={HEIGHT_PX} />
      <rect class="not-played" x={to} y={0} width={axis.right - to} height={HEIGHT_PX} />
    </>
  );
}

/** The times of the pull that is aimed at, or was just made: the focus goes over, and stays. */
function PullTimes({ session, axis }: { session: Session; axis: TimeAxis }): JSX.Element | null {
  const pull = session.pulls.span.value;
  if (!pull) return null;
  const within = (time: number): number => Math.min(Math.max(axis.x(time), axis.left), axis.right);
  const [from, at, to] = [within(pull.start), within(pull.arrival), within(pull.held ?? axis.range.end)];
  return (
    <g class="pull-times" data-start={pull.start} data-arrival={pull.arrival} data-held={pull.held ?? undefined}>
      <path d={`M${from} ${HEIGHT_PX}L${at} 3V${HEIGHT_PX}Z`} />
      <rect x={at} y={3} width={Math.max(to - at, 2)} height={HEIGHT_PX - 3} />
    </g>
  );
}

/** Which frames play without asking the service: those that were seen, and those that are cached. */
function KeptFrames({ session, axis }: { session: Session; axis: TimeAxis }): JSX.Element {
  const half = axis.perFrame / 2;
  const bars = (times: readonly number[]): string =>
    times
      .filter((time) => axis.has(time))
      .map((time) => `M${(axis.x(time) - half).toFixed(1)} ${HEIGHT_PX - 1}h${(2 * half).toFixed(1)}`)
      .join("");
  const cached = session.cache.times.value;
  return (
    <>
      <path class="kept" d={bars(session.pictures.keptTimes.value)}>
        <title>Frames that were seen and are shown at once</title>
      </path>
      <path class="cached" d={bars(cached)} data-cached={cached.length}>
        <title>Cached frames, which play at the shot’s rate</title>
      </path>
    </>
  );
}
