/** Flags in the row of frames where others are: their initials, in their colours. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { formatFrame } from "../../model/time";
import { byFrame, type Gathering } from "../../model/viewers";
import type { TimeAxis } from "../timeline/time_axis";

/** Flags beside each other at one frame; of more, the last one counts. */
const MOST_FLAGS = 3;
const [TOP_PX, HEIGHT_PX, LETTER_PX, PADDING_PX] = [13, 11, 6.5, 4];

export function OtherFlags({ session, axis }: { session: Session; axis: TimeAxis }): JSX.Element {
  return (
    <>
      {byFrame(session.pictures.others.value)
        .filter(({ time }) => axis.has(time))
        .map((gathering) => (
          <Flags key={gathering.time} session={session} axis={axis} gathering={gathering} />
        ))}
    </>
  );
}

interface FlagsProps {
  readonly session: Session;
  readonly axis: TimeAxis;
  readonly gathering: Gathering;
}

/** On the left of the frame, as flags of notes are on its right. */
function Flags({ session, axis, gathering: { time, others } }: FlagsProps): JSX.Element {
  const names = others.map(({ label }) => label).join(", ");
  const more = others.length - MOST_FLAGS;
  const shown = others.slice(0, more > 0 ? MOST_FLAGS - 1 : MOST_FLAGS).map(({ id, initials, colour, camera }) => {
    const isElsewhere = camera !== null && camera !== session.camera;
    return { id, text: initials, colour, isElsewhere };
  });
  if (more > 0) shown.push({ id: "more", text: `+${more + 1}`, colour: "none", isElsewhere: true });
  let left = 0;
  return (
    <g class="other-flags" data-others={names} data-at={time} transform={`translate(${axis.x(time)} 0)`}>
      <title>{`Frame ${formatFrame(time)}: ${names}`}</title>
      <path d={`M0 ${TOP_PX}V26`} />
      {shown.map(({ id, text, colour, isElsewhere }) => {
        const width = LETTER_PX * text.length + PADDING_PX;
        left -= width;
        return (
          <g key={id} class={isElsewhere ? "elsewhere" : undefined} data-color={colour}>
            <rect x={left} y={TOP_PX} width={width - 1} height={HEIGHT_PX} rx={2} />
            <text x={left + (width - 1) / 2} y={TOP_PX + HEIGHT_PX - 2.5} text-anchor="middle">
              {text}
            </text>
          </g>
        );
      })}
    </g>
  );
}
