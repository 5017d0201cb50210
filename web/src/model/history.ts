/**
 * The history of a shot's edits, which the service keeps for all editors and from one visit to the next.
 *
 * Time, selection and playing are momentary and never come here; surround and units are remembered and never come here
 * either.
 */

export interface EditHistory {
  /** Revision of the present state. */
  readonly revision: string;
  /** Revision that an undo goes back to; null for nothing to undo. */
  readonly before: string | null;
  /** Revision that a redo goes on to; null for nothing to do again. */
  readonly after: string | null;
  /** Label of the edit that an undo takes back. */
  readonly undo: string;
  /** Label of the edit that a redo does again. */
  readonly redo: string;
  /** Prim paths of the cameras that the shot has in the present state; null where they were not read with it. */
  readonly cameras: readonly string[] | null;
  /** Another one whenever a note at a frame is another. */
  readonly notesTag: string;
}

export const NO_HISTORY: EditHistory = {
  revision: "",
  before: null,
  after: null,
  undo: "",
  redo: "",
  cameras: null,
  notesTag: "",
};

/** Label of an undo button, such as "Focus on lantern"; null for nothing to undo. */
export function undoLabel(history: EditHistory): string | null {
  return history.before === null ? null : capitalised(history.undo);
}

/** Label of a redo button; null for nothing to redo. */
export function redoLabel(history: EditHistory): string | null {
  return history.after === null ? null : capitalised(history.redo);
}

/** Labels of the service itself are in lower case. */
function capitalised(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
