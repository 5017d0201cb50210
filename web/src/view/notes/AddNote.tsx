/** Buttons that begin a note at the present frame. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";

interface AddNoteProps {
  readonly session: Session;
  /** Of the button for a text. */
  readonly label: string;
  /** Called before a note is begun. */
  readonly onBegin?: () => void;
}

export function AddNote({ session, label, onBegin }: AddNoteProps): JSX.Element {
  const { frameNotes, document } = session;
  const refusal = document.noEdits.value;
  const begin = (draws: boolean): void => {
    onBegin?.();
    frameNotes.begin({ draws });
  };
  return (
    <>
      <button
        type="button"
        class="button"
        disabled={refusal !== null}
        title={refusal ?? "Add a note at this frame (Alt N)"}
        onClick={() => {
          begin(false);
        }}
      >
        {label}
      </button>
      <button
        type="button"
        class="button"
        disabled={refusal !== null}
        title={refusal ?? "Draw on the picture at this frame (Alt P)"}
        onClick={() => {
          begin(true);
        }}
      >
        Draw
      </button>
    </>
  );
}
