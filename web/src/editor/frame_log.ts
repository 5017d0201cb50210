/** The log of an attempt at a frame, read again and again while the attempt goes on. */

import { signal } from "@preact/signals";
import { REFUSED_FOR_NOW } from "../net/answers";
import { complaintOf, isAbort, ServiceError } from "../net/errors";
import type { FrameLogText } from "../net/renders";

/** Rest between two looks, ms. */
const PAUSE_MS = 1000;
/** The same after one that failed. */
const LONG_PAUSE_MS = 5000;

export class FrameLog {
  /** Null until it is known. */
  readonly text = signal<string | null>(null);
  /** Why it cannot be read; null where it can. */
  readonly complaint = signal<string | null>(null);

  readonly #read: (abort: AbortSignal) => Promise<FrameLogText>;

  constructor(read: (abort: AbortSignal) => Promise<FrameLogText>) {
    this.#read = read;
  }

  /** Reads it until the attempt has ended, or until what is returned is called. */
  follow(): () => void {
    const stop = new AbortController();
    let timer: ReturnType<typeof setTimeout> | undefined;
    const look = async (): Promise<void> => {
      let pause = PAUSE_MS;
      try {
        const { text, hasEnded } = await this.#read(stop.signal);
        if (stop.signal.aborted) return;
        this.text.value = text;
        this.complaint.value = null;
        if (hasEnded) return;
      } catch (error) {
        if (isAbort(error) || stop.signal.aborted) return;
        const { message, advice } = complaintOf(error);
        this.complaint.value = `${message} ${advice}`.trim();
        if (error instanceof ServiceError && !REFUSED_FOR_NOW.includes(error.status)) return;
        pause = LONG_PAUSE_MS;
      }
      timer = setTimeout(() => void look(), pause);
    };
    void look();
    return () => {
      clearTimeout(timer);
      stop.abort();
    };
  }
}
