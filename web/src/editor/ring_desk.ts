/** The focus puller's desk: the ring and what turns it, its marks, the recorder, and the takes. */

import { computed, signal, type Signal } from "@preact/signals";
import type { Way } from "../model/gamepad";
import type { Origin } from "../model/ring";
import { MOST_MARKS, MOST_TAKES, NO_NOTES, type PullNotes, type Take } from "../model/take";
import { applyTake, simplify } from "../model/take_edit";
import { MOST_CHANGES } from "../model/key_lanes";
import type { ShotDocument } from "./document";
import type { Fail } from "./fail";
import { FocusRing } from "./focus_ring";
import { noPunchHint, noRoomHint, noTakeHint } from "./hints";
import type { KeptPulls } from "./kept_pulls";
import { browserMidi, MidiInput } from "./midi_input";
import { browserPads, PadInput } from "./pad_input";
import type { Playhead } from "./playhead";
import { Recorder } from "./recorder";

/** What of the desk is remembered, and what keeps the takes. */
export interface DeskChoices {
  /** Whether the ring is shown. */
  readonly shown: Signal<"on" | "off">;
  readonly origin: Signal<Origin>;
  readonly snaps: Signal<"on" | "off">;
  readonly follows: Signal<"on" | "off">;
  readonly midi: Signal<string>;
  readonly lever: Signal<string>;
  readonly way: Signal<Way>;
  readonly kept: KeptPulls | null;
}

/** Choices that last as long as they are used. */
export function usualDesk(): DeskChoices {
  return {
    shown: signal<"on" | "off">("off"),
    origin: signal<Origin>("film"),
    snaps: signal<"on" | "off">("off"),
    follows: signal<"on" | "off">("on"),
    midi: signal(""),
    lever: signal(""),
    way: signal<Way>("absolute"),
    kept: null,
  };
}

/** Share of the distance by which a take may be off, at first, at least and at most. */
export const [TOLERANCE, LEAST_TOLERANCE, MOST_TOLERANCE] = [0.02, 0.002, 0.1];
/** Depths beyond so many close focuses are about as sharp, where a lens has no hyperfocal distance. */
const FAR = 100;

export class RingDesk {
  readonly choices: DeskChoices;
  readonly ring: FocusRing;
  readonly recorder: Recorder;
  readonly midi: MidiInput;
  readonly pad: PadInput;
  readonly notes: Signal<PullNotes>;
  readonly tolerance = signal(TOLERANCE);
  /** Number of the take that is chosen; null for none. */
  readonly chosen = signal<number | null>(null);
  readonly #document: ShotDocument;
  readonly #playhead: Playhead;
  readonly #fail: Fail;
  /** Whether all notes are kept. */
  #isKept = true;

  constructor(document: ShotDocument, playhead: Playhead, choices: DeskChoices, fail: Fail) {
    [this.#document, this.#playhead, this.choices, this.#fail] = [document, playhead, choices, fail];
    this.notes = signal(choices.kept?.find(document.shot.id) ?? NO_NOTES);
    this.chosen.value = this.notes.peek().takes.at(-1)?.number ?? null;
    const marks = computed(() => this.notes.value.marks);
    const ring = new FocusRing(document, playhead, choices, marks);
    this.ring = ring;
    const addTake = (take: Take): void => {
      this.#addTake(take);
    };
    this.recorder = new Recorder(playhead, ring, this.notes, addTake, () => {
      fail(noPunchHint(), () => undefined);
    });
    this.midi = new MidiInput(browserMidi(), choices.midi, (turn) => {
      ring.easeTo(turn);
    });
    this.pad = new PadInput(browserPads(), choices.lever, choices.way, ring);
  }

  /** Reason why nothing can be recorded; null where it can. */
  get refusal(): string | null {
    if (!this.#document.hasLens) return "There is no camera to focus.";
    if (!this.ring.scale.value) return "The lens is not there yet, or has no focus ring.";
    return null;
  }

  /** Sets a mark, by its number from 1 on, at the present distance; null sets the first that is free. */
  setMark(number: number | null = null): void {
    const { marks } = this.#present;
    const free = Array.from({ length: MOST_MARKS }, (_mark, at) => at + 1).find(
      (at) => (marks[at - 1] ?? null) === null,
    );
    const to = number ?? free;
    if (to !== undefined) this.#mark(to, this.ring.distanceM.peek());
  }

  removeMark(number: number): void {
    this.#mark(number, null);
  }

  #mark(number: number, distanceM: number | null): void {
    this.#keep((notes) => ({
      marks: Array.from({ length: MOST_MARKS }, (_mark, at) =>
        at === number - 1 ? distanceM : (notes.marks[at] ?? null),
      ),
    }));
  }

  /** Sets the frame from which on it records, or the last one; null for none. */
  punch(change: Partial<Pick<PullNotes, "punchIn" | "punchOut">>): void {
    const { punchIn, punchOut } = { ...this.#present, ...change };
    const isBackwards = punchIn !== null && punchOut !== null && punchIn >= punchOut;
    const { start, end } = this.#playhead.range;
    const isOut = [punchIn, punchOut].some((time) => time !== null && (time < start || time > end));
    if (isOut) return;
    // The limit that the other one lies beyond goes.
    this.#keep(() => (isBackwards ? { punchIn: null, punchOut: null, ...change } : { punchIn, punchOut }));
  }

  readonly take = computed<Take | null>(
    () => this.notes.value.takes.find(({ number }) => number === this.chosen.value) ?? null,
  );

  /** The chosen take with few keys. */
  readonly simplified = computed(() => {
    const take = this.take.value;
    return take && simplify(take, this.tolerance.value, this.#farM.value);
  });

  readonly #farM = computed(() => {
    const hyperfocalM = this.#document.readout.value?.hyperfocalM ?? Infinity;
    const closeM = this.ring.scale.value?.closeM ?? 1;
    return Number.isFinite(hyperfocalM) && hyperfocalM > closeM ? hyperfocalM : FAR * closeM;
  });

  /** Arms the recorder, or ends what it records. */
  record(): void {
    if (this.recorder.state.peek() === "off") this.recorder.arm();
    else this.recorder.stop();
  }

  /** Throws the chosen take away and records another one. */
  again(): void {
    const take = this.take.peek();
    if (!take) return;
    const hasPunch = this.notes.peek().punchIn !== null;
    if (!hasPunch) this.#playhead.goTo(take.start);
    if (this.recorder.arm()) this.removeTake(take.number);
  }

  removeTake(number: number): void {
    this.#keep(({ takes }) => ({ takes: takes.filter((take) => take.number !== number) }));
    if (this.chosen.peek() === number) this.chosen.value = this.notes.peek().takes.at(-1)?.number ?? null;
  }

  /** Makes the chosen take, with few keys, the focus of the shot. */
  async apply(): Promise<boolean> {
    this.ring.letGo();
    this.#playhead.pause();
    const [simplified, settings] = [this.simplified.peek(), this.#document.focusSettings.peek()];
    const { readout, curve, shot, fresh, solved, revision } = this.#document;
    if (!simplified || !settings) return false;
    const isSolved = solved.revision.peek() === revision.peek();
    const mode = readout.peek()?.focusMode ?? "manual";
    const keys = settings.keys.focusDistanceM ?? [];
    const needsCurve = mode !== "manual" || keys.length === 0;
    const before = { mode, keys, curve: curve.peek(), range: shot.range };
    const changes = applyTake(simplified, before, this.tolerance.peek(), this.#farM.peek());
    if (!fresh.peek() || (needsCurve && !isSolved) || changes.length > MOST_CHANGES) {
      this.#fail(noTakeHint(changes.length > MOST_CHANGES), () => void this.apply());
      return false;
    }
    return this.#document.edit(`Focus by take ${simplified.take.number}`, changes);
  }

  close(): void {
    this.recorder.close();
    this.ring.close();
    this.midi.close();
    this.pad.close();
  }

  #addTake(take: Take): void {
    this.#keep(({ takes }) => {
      const numbers = takes.map(({ number }) => number);
      const number = numbers.includes(take.number) ? Math.max(...numbers) + 1 : take.number;
      this.chosen.value = number;
      return { takes: [...takes, { ...take, number }].slice(-MOST_TAKES) };
    });
  }

  /** The notes, with what other windows have kept of the shot. */
  get #present(): PullNotes {
    const [own, kept] = [this.notes.peek(), this.choices.kept?.find(this.#document.shot.id) ?? null];
    if (!kept) return own;
    if (this.#isKept) return kept;
    const others = kept.takes.filter(({ number }) => !own.takes.some((take) => take.number === number));
    return { ...own, takes: [...others, ...own.takes].toSorted((a, b) => a.number - b.number) };
  }

  #keep(change: (notes: PullNotes) => Partial<PullNotes>): void {
    const notes = this.#present;
    this.notes.value = { ...notes, ...change(notes) };
    const [wasKept, { kept }] = [this.#isKept, this.choices];
    this.#isKept = kept?.keep(this.#document.shot.id, this.notes.peek()) ?? true;
    if (wasKept && !this.#isKept) this.#fail(noRoomHint(), () => undefined);
  }
}
