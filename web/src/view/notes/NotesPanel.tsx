/** The notes of the shot beside the picture: a list of them, and the one that is written. */

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Session } from "../../editor/session";
import type { FrameNote } from "../../model/frame_notes";
import { formatFrame } from "../../model/time";
import { Edits } from "../controls/Edits";
import { Icon } from "../icons";
import { AddNote } from "./AddNote";
import { DraftForm } from "./DraftForm";

export function NotesPanel({ session }: { session: Session }): JSX.Element | null {
  const { frameNotes } = session;
  if (!frameNotes.isShown.value) return null;
  const notes = frameNotes.list.value;
  return (
    <section class="notes-panel" aria-label="Notes">
      <header class="notes-head">
        <h2>Notes</h2>
        <div class="spacer" />
        <button
          type="button"
          class="button icon-only quiet"
          aria-label="Close the notes"
          title="Close the notes (Alt Shift N)"
          onClick={() => {
            frameNotes.cancel();
            frameNotes.isShown.value = false;
          }}
        >
          <Icon name="close" />
        </button>
      </header>
      {frameNotes.draft.value ? (
        <DraftForm session={session} draft={frameNotes.draft.value} />
      ) : (
        <div class="note-actions">
          <AddNote session={session} label={`Add a note at ${formatFrame(session.playhead.time.value)}`} />
        </div>
      )}
      {notes.length === 0 ? (
        <p class="muted">There are no notes yet. They are kept in the shot, and in its edit layer.</p>
      ) : (
        <ul class="notes-list">
          {notes.map((note) => (
            <Row key={note.id} session={session} note={note} />
          ))}
        </ul>
      )}
    </section>
  );
}

function Row({ session, note }: { session: Session; note: FrameNote }): JSX.Element {
  const { frameNotes } = session;
  const row = useRef<HTMLLIElement>(null);
  const isHere = frameNotes.here.value.includes(note);
  const frame = formatFrame(note.time);
  useEffect(() => {
    if (isHere) row.current?.scrollIntoView({ block: "nearest" });
  }, [isHere]);
  return (
    <li
      ref={row}
      class={`note${note.resolved ? " resolved" : ""}`}
      data-note={note.id}
      aria-current={isHere ? "true" : undefined}
    >
      <p class="note-head">
        <button
          type="button"
          class="button small numbers"
          aria-label={`Go to frame ${frame}`}
          title="Go to this frame"
          onClick={() => {
            frameNotes.goTo(note.time);
          }}
        >
          {frame}
        </button>
        <span class="muted">{[note.author, said(note)].filter(Boolean).join(" · ")}</span>
      </p>
      {note.text !== "" && <p class="note-text">{note.text}</p>}
      <Actions session={session} note={note} frame={frame} />
    </li>
  );
}

/** What a note has besides its text. */
function said({ strokes, resolved }: FrameNote): string {
  return [strokes.length > 0 && "drawing", resolved && "resolved"].filter(Boolean).join(", ");
}

function Actions({ session, note, frame }: { session: Session; note: FrameNote; frame: string }): JSX.Element {
  const { frameNotes } = session;
  const [done, at] = [note.resolved ? "Reopen" : "Resolve", `the note at frame ${frame}`];
  return (
    <Edits session={session}>
      <button
        type="button"
        class="button small"
        aria-label={`${done} ${at}`}
        onClick={() => void frameNotes.resolve(note, !note.resolved)}
      >
        {done}
      </button>
      <button
        type="button"
        class="button small"
        aria-label={`Edit ${at}`}
        onClick={() => {
          frameNotes.alter(note);
        }}
      >
        Edit
      </button>
      <button
        type="button"
        class="button small"
        aria-label={`Delete ${at}`}
        onClick={() => void frameNotes.remove(note)}
      >
        Delete
      </button>
    </Edits>
  );
}
