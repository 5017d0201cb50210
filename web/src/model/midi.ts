/** Messages of MIDI controllers (MIDI 1.0 Detailed Specification, control change), as a turn of the ring from 0 to 1. */

/** A controller of a device: what a knob, a fader or a wheel sends. */
export interface Controller {
  /** 0 to 15. */
  readonly channel: number;
  /** 0 to 127. */
  readonly number: number;
}

interface ControlChange extends Controller {
  /** 0 to 127. */
  readonly value: number;
}

/** Controllers up to this one may send a finer part as the controller so much higher. */
const FINE = 32;
const [MOST_7, MOST_14] = [127, 16_383];

/** The control change that bytes are; null for any other message. */
export function controlChange(bytes: ArrayLike<number>): ControlChange | null {
  const [status, number, value] = [bytes[0] ?? 0, bytes[1], bytes[2]];
  if ((status & 0xf0) !== 0xb0 || number === undefined || value === undefined) return null;
  if (number > MOST_7 || value > MOST_7) return null;
  return { channel: status & 0x0f, number, value };
}

/** Reads one controller: in 7 bits, and in 14 as soon as its finer part has come. */
export class ControllerReader {
  readonly #of: Controller;
  #coarse: number | null = null;
  #fine: number | null = null;

  constructor(of: Controller) {
    this.#of = of;
  }

  /** The value, 0 to 1, after a message; null where the message says nothing about it. */
  read(bytes: ArrayLike<number>): number | null {
    const change = controlChange(bytes);
    if (change?.channel !== this.#of.channel) return null;
    if (change.number === this.#of.number) this.#coarse = change.value;
    else if (this.#of.number < FINE && change.number === this.#of.number + FINE) this.#fine = change.value;
    else return null;
    if (this.#coarse === null) return null;
    return this.#fine === null ? this.#coarse / MOST_7 : (this.#coarse * 128 + this.#fine) / MOST_14;
  }
}

/**
 * The controller that a message is of, when one is to be learned.
 *
 * @param before the message before it, where one came; the finer part of a controller is taken for that one.
 */
export function learnedFrom(bytes: ArrayLike<number>, before: Controller | null): Controller | null {
  const change = controlChange(bytes);
  if (!change) return null;
  const { channel, number } = change;
  const isFine = number >= FINE && number < 2 * FINE && before?.channel === channel && before.number === number - FINE;
  return isFine ? before : { channel, number };
}
