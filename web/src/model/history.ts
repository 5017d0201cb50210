/**
 * What can be undone: the service keeps the states of a shot's edits, for all who edit it and from one visit to the next.
 *
 * Time, selection and playing are momentary and never come here; surround and units are remembered and never come here
 * either.
 */

export interface EditHistory {
  /** Of the present state. */
  readonly revision: string;
  /** Revision that an undo goes back to; null for nothing to undo. */
  readonly before: string | null;
  /** Revision that a redo goes on to; null for nothing to do again. */
  readonly after: string | null;
  /** What an undo takes back, in the service's words. */
  readonly undo: string;
  /** What a redo does again, in the service's words. */
  readonly redo: string;
}

export const NO_HISTORY: EditHistory = { revision: "", before: null, after: null, undo: "", redo: "" };

/** What the person called the edits of this visit; those of others have the service's words. */
export type Labels = ReadonlyMap<string, string>;

/** What an undo would take back, for a button: "Focus on lantern"; null for nothing. */
export function undoLabel(history: EditHistory, labels: Labels): string | null {
  return history.before === null ? null : (labels.get(history.revision) ?? capitalised(history.undo));
}

/** What a redo would do again; null for nothing. */
export function redoLabel(history: EditHistory, labels: Labels): string | null {
  return history.after === null ? null : (labels.get(history.after) ?? capitalised(history.redo));
}

function capitalised(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
