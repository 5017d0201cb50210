/** A MIDI device that turns the focus ring. The browser asks the person, once they want one. */

import { signal, type Signal } from "@preact/signals";
import { ControllerReader, learnedFrom, type Controller } from "../model/midi";

/** What of Web MIDI is used. */
export interface MidiPort {
  onmidimessage: ((event: { readonly data: ArrayLike<number> | null }) => void) | null;
  readonly name?: string | null;
}
export interface MidiAccess {
  readonly inputs: { values: () => Iterable<MidiPort> };
  onstatechange: (() => void) | null;
}
export type AskMidi = () => Promise<MidiAccess>;

export type MidiState = "off" | "asking" | "learning" | "on" | "refused";

export class MidiInput {
  readonly state = signal<MidiState>("off");
  /** Number of devices that are there. */
  readonly devices = signal(0);
  /** As words: channel and number; empty for none. */
  readonly #kept: Signal<string>;
  readonly #ask: AskMidi | null;
  readonly #onTurn: (turn: number) => void;
  #access: MidiAccess | null = null;
  /** Counts what was asked for and closed: an answer to an earlier question comes too late. */
  #asked = 0;
  #reader: ControllerReader | null = null;
  #learned: Controller | null = null;

  /**
   * @param ask asks for the devices; null where the browser knows of none.
   * @param onTurn called with the place of the controller, 0 to 1, whenever it is turned.
   */
  constructor(ask: AskMidi | null, kept: Signal<string>, onTurn: (turn: number) => void) {
    [this.#ask, this.#kept, this.#onTurn] = [ask, kept, onTurn];
  }

  get isPossible(): boolean {
    return this.#ask !== null;
  }

  /** The controller that turns the ring; null for none yet. */
  get controller(): Controller | null {
    const [channel, number] = this.#kept.value.split(" ").map(Number);
    return this.#kept.value !== "" && channel !== undefined && number !== undefined ? { channel, number } : null;
  }

  /** Asks for the devices; the controller is the one that was learned before, or is learned now. */
  async connect(): Promise<void> {
    if (!this.#ask) return;
    this.state.value = "asking";
    const asked = (this.#asked += 1);
    try {
      const access = await this.#ask();
      if (this.#asked !== asked) return;
      this.#access = access;
      access.onstatechange = () => {
        this.#listen(access);
      };
      this.#listen(access);
      this.#use();
    } catch {
      if (this.#asked === asked) this.state.value = "refused";
    }
  }

  /** Takes the controller that is turned next. */
  learn(): void {
    if (!this.#access) return;
    this.#learned = null;
    this.#kept.value = "";
    this.#use();
  }

  close(): void {
    this.#asked += 1;
    for (const port of this.#access?.inputs.values() ?? []) port.onmidimessage = null;
    if (this.#access) this.#access.onstatechange = null;
    this.#access = null;
    this.state.value = "off";
  }

  #use(): void {
    const { controller } = this;
    this.#reader = controller && new ControllerReader(controller);
    this.state.value = controller ? "on" : "learning";
  }

  #listen(access: MidiAccess): void {
    const ports = [...access.inputs.values()];
    for (const port of ports) {
      port.onmidimessage = ({ data }) => {
        if (data) this.#take(data);
      };
    }
    this.devices.value = ports.length;
  }

  #take(bytes: ArrayLike<number>): void {
    if (this.state.peek() === "learning") {
      this.#learned = learnedFrom(bytes, this.#learned);
      if (!this.#learned) return;
      this.#kept.value = `${this.#learned.channel} ${this.#learned.number}`;
      this.#use();
    }
    const turn = this.#reader?.read(bytes) ?? null;
    if (turn !== null) this.#onTurn(turn);
  }
}

/** Asks the browser for its MIDI devices; null where it has no Web MIDI. */
export function browserMidi(): AskMidi | null {
  if (typeof navigator === "undefined" || !("requestMIDIAccess" in navigator)) return null;
  return async () => (await navigator.requestMIDIAccess()) as unknown as MidiAccess;
}
