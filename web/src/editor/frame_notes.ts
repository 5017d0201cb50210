/** Notes at frames of the open shot: as they are kept, as they are written, and drawn. */

import { batch, computed, signal, untracked, type ReadonlySignal } from "@preact/signals";
import type { Changes } from "../model/changes";
import {
  clashes,
  drawnTo,
  isWritten,
  keepDraft,
  nextTime,
  notesAt,
  rebased,
  refusalOf,
  roomFor,
  seenThrough,
  WIDTHS,
  withChanges,
  type Colour,
  type Draft,
  type FrameNote,
  type Stroke,
  type Width,
} from "../model/frame_notes";
import { NO_HISTORY } from "../model/history";
import { formatFrame } from "../model/time";
import { isAbort, ServiceError } from "../net/errors";
import type { Service } from "../net/service";
import type { ShotDocument } from "./document";
import type { Fail } from "./fail";
import type { Playhead } from "./playhead";

type Place = readonly [number, number];

export class FrameNotes {
  /** Whether the list is shown. */
  readonly isShown = signal(false);
  /** Counts how often the draft was called for: its text has the keyboard then. */
  readonly calls = signal(0);
  /** The note that is written; null for none. */
  readonly draft = signal<Draft | null>(null);
  /** Whether the pointer draws on the picture. */
  readonly isDrawing = signal(false);
  readonly colour = signal<Colour>("red");
  readonly width = signal<Width>("medium");
  /** The stroke under the pointer. */
  readonly stroke = signal<Stroke | null>(null);
  readonly #saved = signal<readonly FrameNote[]>([]);
  /** Tag of the notes that were read last. */
  #tag = NO_HISTORY.notesTag;
  /** Changes on their way, which the list shows already. */
  readonly #pending = signal<readonly Changes[]>([]);
  readonly #service: Pick<Service, "frameNotes">;
  readonly #document: ShotDocument;
  readonly #playhead: Playhead;
  readonly #fail: Fail;
  #reading: AbortController | null = null;
  /** Whether the notes have to be read once nothing is on its way. */
  #isStale = false;

  constructor(service: Pick<Service, "frameNotes">, document: ShotDocument, playhead: Playhead, fail: Fail) {
    [this.#service, this.#document, this.#playhead, this.#fail] = [service, document, playhead, fail];
  }

  /** The notes of this camera and of all cameras, in order of time. */
  readonly list: ReadonlySignal<readonly FrameNote[]> = computed(() =>
    seenThrough(this.#pending.value.reduce(withChanges, this.#saved.value), this.#document.view.camera),
  );

  /** Notes at the present frame. */
  readonly here = computed(() => this.#at(this.#playhead.time.value, this.list.value));

  /** Strokes over a picture of a time: of the notes there that are not resolved, and of the draft in place of its note. */
  strokesAt(time: number): readonly Stroke[] {
    const draft = this.draft.value;
    const kept = this.#at(time, this.list.value).filter(({ resolved, id }) => !resolved && id !== draft?.id);
    const own = draft ? seenThrough(this.#at(time, [draft]), this.#document.view.camera) : [];
    const now = own.length > 0 && this.stroke.value ? [this.stroke.value] : [];
    return [...[...kept, ...own].flatMap(({ strokes }) => strokes), ...now];
  }

  /** Reason why the draft cannot be drawn on; null where it can. */
  readonly noDrawing = computed(() => {
    const draft = this.draft.value;
    const isOther = draft && seenThrough([draft], this.#document.view.camera).length === 0;
    return isOther ? "The note belongs to the picture of another camera." : null;
  });

  /** Whether the pointer draws on a picture of a time: on that of the draft alone, and at rest. */
  drawsOn(time: number): boolean {
    const draft = this.draft.value;
    if (!draft || !this.isDrawing.value || this.#playhead.playing.value) return false;
    return this.noDrawing.value === null && this.#at(time, [draft]).length > 0;
  }

  #at<At extends Pick<FrameNote, "time">>(time: number, notes: readonly At[]): readonly At[] {
    return notesAt(this.#playhead.range, notes, time);
  }

  /** Reads the notes where they are not those that were read: an effect, after a new history or revision of the document. */
  keepUp(): void {
    const { history, revision } = this.#document;
    const [tag] = [history.value.notesTag, revision.value]; // tags of notes count from a revision on
    if (tag !== this.#tag) void untracked(() => this.read());
  }

  /** Reads the notes; where some are on their way, after those. */
  async read(fail = this.#fail): Promise<void> {
    this.#isStale = this.#pending.peek().length > 0;
    if (this.#isStale) return;
    this.#reading?.abort();
    const reading = new AbortController();
    this.#reading = reading;
    try {
      const { notes, notesTag } = await this.#service.frameNotes(this.#document.view, reading.signal);
      if (reading.signal.aborted) return;
      [this.#saved.value, this.#tag] = [notes, notesTag];
    } catch (error) {
      if (!reading.signal.aborted && !isAbort(error)) fail(error, () => void this.read());
    }
  }

  /** Begins a new note at this frame, unless one is written already: then that one goes on. */
  begin({ draws = false } = {}): void {
    if (this.#goesOn()) {
      if (draws) this.draw(true);
      return;
    }
    const [time, { camera }] = [this.#playhead.time.peek(), this.#document.view];
    this.#open({ id: newId(), opened: null, time, camera, text: "", strokes: [] }, draws);
  }

  /** Goes to a note and alters it, unless one is written already: then that one goes on. */
  alter(opened: FrameNote): void {
    if (this.#goesOn()) return;
    const { id, time, camera, text, strokes } = opened;
    this.#playhead.goTo(time);
    this.#open({ id, opened, time, camera, text, strokes }, false);
  }

  /** Shows the draft where it has something that would be lost with it, and returns whether it has. */
  #goesOn(): boolean {
    const draft = this.draft.peek();
    if (!draft || !isWritten(draft)) return false;
    batch(() => {
      this.isShown.value = true;
      this.calls.value += 1;
    });
    return true;
  }

  #open(draft: Draft, draws: boolean): void {
    this.#playhead.pause();
    batch(() => {
      [this.isShown.value, this.draft.value, this.isDrawing.value, this.stroke.value] = [true, draft, draws, null];
    });
  }

  write(text: string): void {
    const draft = this.draft.peek();
    if (draft) this.draft.value = { ...draft, text };
  }

  /** Draws on the picture of the draft's frame, or not any more. */
  draw(isDrawing: boolean): void {
    const draft = this.draft.peek();
    if (!draft || this.noDrawing.peek() !== null) return;
    this.#playhead.pause();
    this.#playhead.goTo(draft.time);
    this.isDrawing.value = isDrawing;
  }

  /** Puts the pen down at a place of the picture. */
  penDown(place: Place, aspect: number): void {
    const draft = this.draft.peek();
    const [room, colour, width] = [roomFor(draft?.strokes ?? []), this.colour.peek(), WIDTHS[this.width.peek()]];
    if (draft && room > 0) this.stroke.value = drawnTo({ points: [], colour, width }, place, aspect, room);
  }

  penTo(place: Place, aspect: number): void {
    const [draft, stroke] = [this.draft.peek(), this.stroke.peek()];
    if (draft && stroke) this.stroke.value = drawnTo(stroke, place, aspect, roomFor(draft.strokes));
  }

  penUp(): void {
    const [draft, stroke] = [this.draft.peek(), this.stroke.peek()];
    batch(() => {
      if (draft && stroke) this.draft.value = { ...draft, strokes: [...draft.strokes, stroke] };
      this.stroke.value = null;
    });
  }

  /** Takes the last stroke of the draft away. */
  undoStroke(): void {
    const draft = this.draft.peek();
    if (draft) this.draft.value = { ...draft, strokes: draft.strokes.slice(0, -1) };
  }

  /** Keeps the draft in the shot; one that says nothing stays open. */
  keep(): void {
    const draft = this.draft.peek();
    if (!draft || refusalOf(draft) !== null) return;
    const now = this.#noteOf(draft);
    if (now && clashes(draft, now)) {
      this.draft.value = rebased(draft, now); // who keeps it now has been told
      this.#fail(changedMeanwhile(), () => {
        this.keep();
      });
      return;
    }
    this.cancel();
    const label = `${now ? "Edit note" : "Add note"} at frame ${formatFrame(draft.time)}`;
    void this.#edit(label, keepDraft(draft, now), draft);
  }

  #noteOf({ id }: Draft): FrameNote | null {
    return this.list.peek().find((note) => note.id === id) ?? null;
  }

  /** Drops the draft. */
  cancel(): void {
    batch(() => {
      [this.draft.value, this.isDrawing.value, this.stroke.value] = [null, false, null];
    });
  }

  resolve({ id, time }: FrameNote, resolved: boolean): Promise<void> {
    const label = `${resolved ? "Resolve" : "Reopen"} note at frame ${formatFrame(time)}`;
    return this.#edit(label, [{ type: "editNote", id, values: { resolved } }]);
  }

  remove({ id, time }: FrameNote): Promise<void> {
    if (this.draft.peek()?.id === id) this.cancel();
    return this.#edit(`Delete note at frame ${formatFrame(time)}`, [{ type: "deleteNote", id }]);
  }

  /** Frame of the next note, or with -1 of the one before; null for none. */
  next(way: 1 | -1): number | null {
    return nextTime(this.#playhead.range, this.list.value, this.#playhead.time.value, way);
  }

  goTo(time: number | null): void {
    if (time !== null) this.#playhead.goTo(time);
  }

  /** Goes on with what was written in a session of the same shot that this one replaces. */
  follow({ isShown, draft, colour, width }: FrameNotes): void {
    const [{ cameraPaths }, written] = [this.#document.shot, draft.peek()];
    const isGone = written?.camera && !cameraPaths.includes(written.camera);
    batch(() => {
      [this.isShown.value, this.colour.value, this.width.value] = [isShown.peek(), colour.peek(), width.peek()];
      this.draft.value = written && isGone ? { ...written, camera: this.#document.view.camera } : written;
    });
  }

  close(): void {
    this.#reading?.abort();
  }

  /**
   * Makes an edit, which the list shows at once. What could not be kept of a draft is opened again, until it is kept by another try
   * at the same edit.
   */
  async #edit(label: string, changes: Changes, draft: Draft | null = null): Promise<void> {
    if (changes.length === 0) return;
    let open = draft;
    this.#pending.value = [...this.#pending.peek(), changes];
    const isMade = await this.#document.edit(label, changes, undefined, undefined, () => {
      if (open && this.draft.peek() === open) this.cancel();
    });
    const isLast = this.#pending.peek().length === 1;
    this.#reading?.abort(); // it may have been answered before the edit was made
    this.#isStale ||= !isMade;
    if (isMade && !isLast) this.#saved.value = withChanges(this.#saved.peek(), changes);
    if (isMade && isLast) await this.#readMade(changes);
    else this.#drop(changes);
    if (!isMade && draft && this.draft.peek() === null) this.draft.value = draft;
    if (!this.#isStale) return;
    await this.read(() => undefined); // what is told of the edit stays
    const now = open && this.#noteOf(open);
    if (isMade || !open || !now || this.draft.peek() !== open) return;
    this.draft.value = open = rebased(open, now); // who keeps it now has been told of what others have made of it
  }

  /** Reads the notes with what was made of them, before that is shown no more as on its way. */
  async #readMade(changes: Changes): Promise<void> {
    const made = withChanges(this.#saved.peek(), changes);
    this.#isStale = false;
    const read = await this.#service.frameNotes(this.#document.view).catch(() => {
      this.#isStale = true;
      return { notes: made, notesTag: this.#tag };
    });
    batch(() => {
      const isLast = this.#pending.peek().length === 1;
      [this.#saved.value, this.#tag] = isLast ? [read.notes, read.notesTag] : [made, this.#tag];
      this.#drop(changes);
    });
  }

  #drop(changes: Changes): void {
    this.#pending.value = this.#pending.peek().filter((one) => one !== changes);
  }
}

function changedMeanwhile(): ServiceError {
  return new ServiceError({ code: "changed_meanwhile", detail: "Somebody else has changed the note." }, 412);
}

function newId(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(6));
  return `note_${[...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("")}`;
}
