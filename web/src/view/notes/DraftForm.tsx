/** The note that is written: its text, and its drawing over the picture. */

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { FrameNotes } from "../../editor/frame_notes";
import type { Session } from "../../editor/session";
import { COLOURS, MOST_TEXT, refusalOf, type Colour, type Draft, type Width } from "../../model/frame_notes";
import { formatFrame } from "../../model/time";
import { Radios } from "../controls/Radios";

export function DraftForm({ session, draft }: { session: Session; draft: Draft }): JSX.Element {
  const { frameNotes } = session;
  const text = useRef<HTMLTextAreaElement>(null);
  const what = `${draft.id} ${frameNotes.calls.value}`;
  useEffect(() => {
    text.current?.focus();
  }, [what]);
  const refusal = refusalOf(draft);
  return (
    <form
      class="note-draft"
      aria-label={draft.opened === null ? "New note" : "Note"}
      onSubmit={(event) => {
        event.preventDefault();
        frameNotes.keep();
      }}
      onKeyDown={(event) => {
        if (event.key === "Escape") frameNotes.cancel();
        else if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) frameNotes.keep();
        else return;
        event.preventDefault();
        event.stopPropagation();
      }}
    >
      <label>
        Note at frame {formatFrame(draft.time)}
        <textarea
          ref={text}
          rows={3}
          maxLength={MOST_TEXT}
          value={draft.text}
          onInput={(event) => {
            frameNotes.write(event.currentTarget.value);
          }}
        />
      </label>
      <Pen frameNotes={frameNotes} draft={draft} />
      <div class="note-actions">
        <button
          type="submit"
          class="button primary"
          disabled={refusal !== null}
          title={refusal ?? "Keep the note in the shot (Ctrl Enter)"}
        >
          Keep
        </button>
        <button
          type="button"
          class="button"
          title="Drop what was written (Esc)"
          onClick={() => {
            frameNotes.cancel();
          }}
        >
          Cancel
        </button>
      </div>
    </form>
  );
}

const COLOUR_NAMES: Readonly<Record<Colour, string>> = { red: "Red", yellow: "Yellow", cyan: "Cyan", white: "White" };
const WIDTH_NAMES: Readonly<Record<Width, string>> = { fine: "Fine", medium: "Medium", bold: "Bold" };

function Pen({ frameNotes, draft }: { frameNotes: FrameNotes; draft: Draft }): JSX.Element {
  const { isDrawing, colour, width } = frameNotes;
  const refusal = frameNotes.noDrawing.value;
  const count = draft.strokes.length;
  return (
    <div class="note-pen">
      <button
        type="button"
        class="button"
        aria-pressed={isDrawing.value}
        disabled={refusal !== null}
        title={refusal ?? "Draw on the picture with the pointer"}
        onClick={() => {
          frameNotes.draw(!isDrawing.value);
        }}
      >
        Draw
      </button>
      <button
        type="button"
        class="button"
        disabled={count === 0}
        title="Take the last stroke away (Ctrl Z while the pen draws)"
        onClick={() => {
          frameNotes.undoStroke();
        }}
      >
        Undo stroke
      </button>
      {isDrawing.value && (
        <>
          <Radios
            label="Colour of the pen"
            kind="pen-colours"
            values={COLOURS}
            value={colour.value}
            names={COLOUR_NAMES}
            onChoose={(name) => (colour.value = name)}
          />
          <Radios
            label="Width of the pen"
            values={["fine", "medium", "bold"]}
            value={width.value}
            names={WIDTH_NAMES}
            onChoose={(name) => (width.value = name)}
          />
        </>
      )}
    </div>
  );
}
