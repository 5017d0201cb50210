/** A game controller that turns the focus ring. */

import { signal, type Signal } from "@preact/signals";
import { leverAt, movedLever, rateOf, turnOf, type Lever, type Pad, type Way } from "../model/gamepad";

/** Reads the game controllers that are there. */
export type ReadPads = () => readonly (Pad | null)[];

export type PadState = "off" | "learning" | "on";

/** Turns of the whole ring in a second at full speed. */
const MOST_RATE = 0.5;
/** Change of a lever that is a move. */
const LEAST_MOVE = 2e-3;

export class PadInput {
  readonly state = signal<PadState>("off");
  /** Whether a controller is there; browsers show one once a button of it was pressed. */
  readonly isThere = signal(false);
  /** As words: axis or button and its index; empty for none. */
  readonly #kept: Signal<string>;
  readonly #way: Signal<Way>;
  readonly #read: ReadPads | null;
  readonly #ring: { easeTo: (turn: number) => void; turnBy: (by: number) => void };
  #before: Pad | null = null;
  #last: number | null = null;
  #lastMs = 0;
  #request = 0;

  /** @param read null where the browser knows of no game controllers. */
  constructor(
    read: ReadPads | null,
    kept: Signal<string>,
    way: Signal<Way>,
    ring: { easeTo: (turn: number) => void; turnBy: (by: number) => void },
  ) {
    [this.#read, this.#kept, this.#way, this.#ring] = [read, kept, way, ring];
  }

  get isPossible(): boolean {
    return this.#read !== null;
  }

  get lever(): Lever | null {
    const [kind, index] = this.#kept.value.split(" ");
    return kind === "axis" || kind === "button" ? { kind, index: Number(index) } : null;
  }

  /** Follows the lever that was learned before, or learns one. */
  connect(): void {
    if (!this.#read || this.state.peek() !== "off") return;
    this.state.value = this.lever ? "on" : "learning";
    [this.#before, this.#last, this.#lastMs] = [null, null, performance.now()];
    this.#request = requestAnimationFrame(this.#look);
  }

  /** Takes the lever that is moved next. */
  learn(): void {
    this.#kept.value = "";
    [this.#before, this.#last] = [null, null];
    if (this.state.peek() === "off") this.connect();
    else this.state.value = "learning";
  }

  close(): void {
    cancelAnimationFrame(this.#request);
    this.state.value = "off";
  }

  readonly #look = (): void => {
    const pad = this.#read?.().find((one) => one !== null) ?? null;
    const now = performance.now();
    this.isThere.value = pad !== null;
    if (pad && this.state.peek() === "learning") this.#learnFrom(pad);
    else if (pad) this.#turn(pad, (now - this.#lastMs) / 1000);
    this.#lastMs = now;
    this.#request = requestAnimationFrame(this.#look);
  };

  #learnFrom(pad: Pad): void {
    this.#before ??= { axes: [...pad.axes], buttons: pad.buttons.map(({ value }) => ({ value })) };
    const lever = movedLever(this.#before, pad);
    if (!lever) return;
    this.#kept.value = `${lever.kind} ${lever.index}`;
    this.state.value = "on";
  }

  #turn(pad: Pad, seconds: number): void {
    const { lever } = this;
    const at = lever && leverAt(pad, lever);
    if (!lever || at === null) return;
    if (this.#way.peek() === "rate") {
      const rate = rateOf(at);
      if (rate !== 0) this.#ring.turnBy(rate * MOST_RATE * Math.min(seconds, 0.1));
      return;
    }
    // One that lies still leaves the ring to others.
    const isMoved = this.#last !== null && Math.abs(at - this.#last) > LEAST_MOVE;
    if (isMoved) this.#ring.easeTo(turnOf(lever, at));
    if (isMoved || this.#last === null) this.#last = at;
  }
}

/** Reads the game controllers of the browser; null where it has no Gamepad API. */
export function browserPads(): ReadPads | null {
  if (typeof navigator === "undefined" || !("getGamepads" in navigator)) return null;
  return () => navigator.getGamepads();
}
