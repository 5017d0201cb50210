/** Commands of notes at frames. */

import type { Session } from "../../editor/session";
import { onShot, type Command, type SessionCommand } from "./command";

const isWriting = ({ frameNotes }: Session): string | null =>
  frameNotes.draft.value === null ? "No note is written." : null;
const mayEdit = ({ document }: Session): string | null => document.noEdits.value;

const NOTES: readonly SessionCommand[] = [
  {
    name: "Add a note at this frame",
    keys: ["Alt N"],
    refusal: mayEdit,
    act: ({ frameNotes }) => {
      frameNotes.begin();
    },
  },
  {
    name: "Draw on the picture at this frame",
    keys: ["Alt P"],
    isOn: ({ frameNotes }) => frameNotes.isDrawing.value,
    refusal: (session) => mayEdit(session) ?? session.frameNotes.noDrawing.value,
    act: ({ frameNotes }) => {
      if (frameNotes.draft.value) frameNotes.draw(!frameNotes.isDrawing.value);
      else frameNotes.begin({ draws: true });
    },
  },
  {
    name: "Notes",
    keys: ["Alt Shift N"],
    isOn: ({ frameNotes }) => frameNotes.isShown.value,
    act: ({ frameNotes }) => {
      frameNotes.isShown.value = !frameNotes.isShown.value;
    },
  },
  ...([1, -1] as const).map((way): SessionCommand => ({
    name: way > 0 ? "Go to the next note" : "Go to the previous note",
    keys: [way > 0 ? "Alt ." : "Alt ,"],
    refusal: ({ frameNotes }) =>
      frameNotes.next(way) === null ? `There is no note ${way > 0 ? "after" : "before"} this frame.` : null,
    act: ({ frameNotes }) => {
      frameNotes.goTo(frameNotes.next(way));
    },
  })),
  {
    name: "Resolve the notes at this frame, or reopen them",
    keys: ["Alt Y"],
    refusal: (session) => mayEdit(session) ?? (session.frameNotes.here.value.length > 0 ? null : "No note is here."),
    act: ({ frameNotes }) => {
      const notes = frameNotes.here.value;
      const resolved = notes.some((note) => !note.resolved);
      for (const note of notes.filter((one) => one.resolved !== resolved)) void frameNotes.resolve(note, resolved);
    },
  },
];

export const NOTE_COMMANDS: readonly Command[] = NOTES.map((command) => onShot("Picture", command));

/** Those of the note that is written, whose keys mean other things where there is none. */
export const DRAFT_COMMANDS: readonly Command[] = [
  onShot("Picture", {
    name: "Take the last stroke away",
    keys: ["Ctrl Z"],
    wantsKey: ({ frameNotes }) => frameNotes.isDrawing.value,
    refusal: ({ frameNotes }) => ((frameNotes.draft.value?.strokes.length ?? 0) > 0 ? null : "Nothing is drawn."),
    act: ({ frameNotes }) => {
      frameNotes.undoStroke();
    },
  }),
  onShot("Picture", {
    name: "Keep the note",
    keys: ["Ctrl Enter"],
    refusal: isWriting,
    act: ({ frameNotes }) => {
      frameNotes.keep();
    },
  }),
  onShot("Picture", {
    name: "Drop the note that is written",
    keys: ["Escape"],
    refusal: isWriting,
    act: ({ frameNotes }) => {
      frameNotes.cancel();
    },
  }),
];
