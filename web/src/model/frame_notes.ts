/** Notes at frames, which the shot keeps: texts and drawings over the picture. */

import type { components } from "../net/schema";
import type { Changes } from "./changes";
import { snapToFrame, type FrameRange } from "./time";

export type FrameNote = Omit<components["schemas"]["ShotNote"], "etag">;
export type Stroke = components["schemas"]["NoteStroke"];
type Place = readonly [number, number];

export const COLOURS = ["red", "yellow", "cyan", "white"] as const satisfies readonly Stroke["colour"][];
export type Colour = (typeof COLOURS)[number];

/** Widths of strokes, shares of the picture's height. */
export const WIDTHS = { fine: 0.003, medium: 0.006, bold: 0.014 } as const;
export type Width = keyof typeof WIDTHS;

/** Limits of the service: characters, strokes, points of all strokes of a note. */
export const [MOST_TEXT, MOST_STROKES, MOST_POINTS] = [2000, 100, 4000];
/** Distance from one point of a stroke to the next, a share of the picture's height. */
const LEAST_STEP = 0.003;
const DIGITS = 1e4;

/** The notes of a shot. */
export interface NoteList {
  readonly notes: readonly FrameNote[];
  /** Another one whenever one of them is another. */
  readonly notesTag: string;
}

/** A note as it is written. */
export interface Draft {
  /** Of the note that it alters, or that it is to be. */
  readonly id: string;
  /** The note as it was when its draft was opened; null for a new one. */
  readonly opened: FrameNote | null;
  readonly time: number;
  /** Prim path of the camera whose picture it belongs to; null for all. */
  readonly camera: string | null;
  readonly text: string;
  readonly strokes: readonly Stroke[];
}

/** Why a draft cannot be kept; null where it can. */
export function refusalOf({ text, strokes }: Draft): string | null {
  if (text.trim() === "" && strokes.length === 0) return "A note has text or a drawing.";
  if (text.length > MOST_TEXT) return `A note has at most ${MOST_TEXT} characters.`;
  return null;
}

/** Text without the control characters that come with what is pasted; line breaks stay. */
export function plainText(text: string): string {
  return text.replace(/\r\n?/g, "\n").replace(/(?!\n)[\p{Cc}\p{Zl}\p{Zp}]/gu, " ");
}

/** Whether a draft has anything that its note has not. */
export function isWritten({ opened, text, strokes }: Draft): boolean {
  return saidIn(text) !== saidIn(opened?.text ?? "") || !sameStrokes(strokes, opened?.strokes ?? []);
}

/**
 * The changes that keep a draft: those of a note that is there name what the writer has changed of it alone, so that they leave what
 * others have changed since.
 *
 * @param now the note as it is; null where there is none, or none any more.
 */
export function keepDraft(draft: Draft, now: FrameNote | null): Changes {
  const { id, time, camera, strokes } = draft;
  const text = saidIn(draft.text);
  if (!now && !isWritten(draft)) return [];
  if (!now) return [{ type: "addNote", note: { id, time, camera, text, strokes: [...strokes] } }];
  const before = draft.opened ?? now;
  const values = {
    ...(text !== saidIn(before.text) && { text }),
    ...(!sameStrokes(strokes, before.strokes) && { strokes: [...strokes] }),
  };
  return Object.keys(values).length > 0 ? [{ type: "editNote", id, values }] : [];
}

/** Whether others have changed since a draft was opened what it changes, too. */
export function clashes(draft: Draft, now: FrameNote | null): boolean {
  const { opened } = draft;
  if (!opened || !now) return false;
  const [text, strokes] = [saidIn(draft.text), draft.strokes];
  const areTexts = ![saidIn(opened.text), saidIn(now.text)].includes(text) && saidIn(now.text) !== saidIn(opened.text);
  const areDrawings =
    ![opened, now].some((note) => sameStrokes(note.strokes, strokes)) && !sameStrokes(now.strokes, opened.strokes);
  return areTexts || areDrawings;
}

/** A draft over the note as others have left it: with what the writer has changed, and the rest as it is now. */
export function rebased(draft: Draft, now: FrameNote): Draft {
  const { opened, text, strokes } = draft;
  return {
    ...draft,
    opened: now,
    text: opened && saidIn(text) === saidIn(opened.text) ? now.text : text,
    strokes: opened && sameStrokes(strokes, opened.strokes) ? now.strokes : strokes,
  };
}

function saidIn(text: string): string {
  return plainText(text).trim();
}

function sameStrokes(some: readonly Stroke[], others: readonly Stroke[]): boolean {
  return some.length === others.length && some.every((stroke, at) => isSame(stroke, others[at]));
}

function isSame({ points, colour, width }: Stroke, other: Stroke | undefined): boolean {
  if (colour !== other?.colour || width !== other.width || points.length !== other.points.length) return false;
  return points.every(([x, y], at) => x === other.points[at]?.[0] && y === other.points[at]?.[1]);
}

/** The notes as changes make them. */
export function withChanges(notes: readonly FrameNote[], changes: Changes): readonly FrameNote[] {
  return changes.reduce<readonly FrameNote[]>((list, change) => {
    if (change.type === "addNote") {
      const { id, time, camera = null, text = "", strokes = [] } = change.note;
      const added = {
        id: id ?? "",
        time,
        camera,
        text,
        strokes,
        author: "",
        created: "",
        modified: "",
        resolved: false,
      };
      return inOrder([...list.filter((note) => note.id !== id), added]);
    }
    if (change.type === "deleteNote") return list.filter((note) => note.id !== change.id);
    if (change.type !== "editNote") return list;
    const given = Object.entries(change.values).filter(([, value]) => value !== null);
    return list.map((note) => (note.id === change.id ? { ...note, ...Object.fromEntries(given) } : note));
  }, notes);
}

function inOrder(notes: readonly FrameNote[]): readonly FrameNote[] {
  return [...notes].sort((one, other) => one.time - other.time);
}

/** Notes that belong to the picture of a camera. */
export function seenThrough<Seen extends Pick<FrameNote, "camera">>(
  notes: readonly Seen[],
  camera: string | null,
): readonly Seen[] {
  return notes.filter((note) => (note.camera ?? camera) === camera);
}

/** Notes whose frame is that of a time. A note between two frames, or outside of the range, is at the frame that is nearest. */
export function notesAt<At extends Pick<FrameNote, "time">>(
  range: FrameRange,
  notes: readonly At[],
  time: number,
): readonly At[] {
  return notes.filter((note) => snapToFrame(range, note.time) === snapToFrame(range, time));
}

/** Frame of the next note after a time, or with -1 of the one before; null for none. */
export function nextTime(range: FrameRange, notes: readonly FrameNote[], time: number, way: 1 | -1): number | null {
  const frames = notes.map((note) => snapToFrame(range, note.time));
  const beyond = frames.filter((at) => Math.sign(at - snapToFrame(range, time)) === way);
  if (beyond.length === 0) return null;
  return way > 0 ? Math.min(...beyond) : Math.max(...beyond);
}

/** A stroke that goes on to a place, unless that is too near or there is no room left for it. */
export function drawnTo(stroke: Stroke, [x, y]: Place, aspect: number, room: number): Stroke {
  const next: [number, number] = [held(x), held(y)];
  const last = stroke.points.at(-1);
  const isNear = last && Math.hypot((next[0] - (last[0] ?? 0)) * aspect, next[1] - (last[1] ?? 0)) < LEAST_STEP;
  return isNear === true || stroke.points.length >= room ? stroke : { ...stroke, points: [...stroke.points, next] };
}

function held(share: number): number {
  return Math.round(Math.min(Math.max(share, 0), 1) * DIGITS) / DIGITS;
}

/** Room for points of one more stroke. */
export function roomFor(strokes: readonly Stroke[]): number {
  if (strokes.length >= MOST_STROKES) return 0;
  return MOST_POINTS - strokes.reduce((count, { points }) => count + points.length, 0);
}

/** Path of a stroke where the picture is as high as 1 and as wide as its aspect; one point is a dot. */
export function pathOf({ points }: Stroke, aspect: number): string {
  const places = points.map(([x = 0, y = 0]) => `${(x * aspect).toFixed(4)} ${y.toFixed(4)}`);
  return `M${places.join("L")}${places.length === 1 ? "h0.0001" : ""}`;
}
