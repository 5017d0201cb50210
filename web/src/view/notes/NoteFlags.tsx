/** Flags in the row of frames where the shot has notes. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import type { FrameNote } from "../../model/frame_notes";
import { formatFrame } from "../../model/time";
import type { TimeAxis } from "../timeline/time_axis";

/** Characters of a note that its flag tells. */
const MOST_TOLD = 120;

export function NoteFlags({ session, axis }: { session: Session; axis: TimeAxis }): JSX.Element {
  return (
    <>
      {session.frameNotes.list.value
        .filter((note) => axis.has(note.time))
        .map((note) => (
          <g
            key={note.id}
            class={note.resolved ? "note-flag resolved" : "note-flag"}
            data-flag={note.time}
            transform={`translate(${axis.x(note.time)} 0)`}
          >
            <title>{told(note)}</title>
            <path d="M0 24V13H8L6 16L8 19H0" />
          </g>
        ))}
    </>
  );
}

function told({ time, author, text, strokes }: FrameNote): string {
  const words = text === "" ? (strokes.length > 0 ? "a drawing" : "") : text.slice(0, MOST_TOLD);
  return `Frame ${formatFrame(time)}${author === "" ? "" : `, ${author}`}: ${words}`;
}
