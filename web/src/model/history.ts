/**
 * What can be undone: a row of edits and how many of them are done.
 *
 * An edit is data (what to ask of the service to do it, and to take it back), so that this file knows no service. Time,
 * selection and playing are momentary and never come here; surround and units are remembered and never come here either.
 */

export interface Edit<Command> {
  /** For the person: "Focus on lantern". */
  readonly label: string;
  readonly redo: readonly Command[];
  readonly undo: readonly Command[];
}

export interface History<Command> {
  readonly edits: readonly Edit<Command>[];
  /** How many of `edits` are done; those after it were undone. */
  readonly done: number;
}

const LONGEST = 200;

export function emptyHistory<Command>(): History<Command> {
  return { edits: [], done: 0 };
}

/** After a new edit; what was undone is forgotten. */
export function pushed<Command>(history: History<Command>, edit: Edit<Command>): History<Command> {
  const edits = [...history.edits.slice(0, history.done), edit].slice(-LONGEST);
  return { edits, done: edits.length };
}

/** The edit that undo takes back, if any. */
export function undoable<Command>(history: History<Command>): Edit<Command> | null {
  return history.edits[history.done - 1] ?? null;
}

/** The edit that redo does again, if any. */
export function redoable<Command>(history: History<Command>): Edit<Command> | null {
  return history.edits[history.done] ?? null;
}

/** After one undo (-1) or redo (+1). */
export function moved<Command>(history: History<Command>, by: -1 | 1): History<Command> {
  return { ...history, done: Math.min(Math.max(history.done + by, 0), history.edits.length) };
}
