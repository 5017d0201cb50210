/** Requests that are refused for now, and are sent again: once somebody has signed in, or after the wait that the service asks for. */

import { ServiceError } from "./errors";

/** Times that a request is sent again after a wait; then its refusal is an error. */
const MOST_WAITS = 4;
const LONGEST_WAIT_S = 30;

export interface PatienceListener {
  /** Asks for a key; resolves to whether somebody has signed in. */
  onSignInNeeded(): Promise<boolean>;
  /** Takes the refusal that is waited out, with the seconds of the wait; null where nothing waits any more. */
  onWaiting(refusal: ServiceError | null, waitS: number): void;
}

export class Patience {
  listener: PatienceListener | null = null;
  #waiting = 0;

  /**
   * Makes a request, as often as that may help.
   *
   * @param isSafe whether it changes nothing, so that it may be sent again although part of it was done.
   * @throws what `attempt` throws, or an AbortError.
   */
  async send<Result>(attempt: () => Promise<Result>, isSafe: boolean, signal?: AbortSignal): Promise<Result> {
    for (let waits = 0; ;) {
      try {
        return await attempt();
      } catch (error) {
        if (!(error instanceof ServiceError) || !this.listener) throw error;
        if (error.status === 401) {
          if (!(await this.listener.onSignInNeeded())) throw error;
        } else {
          const waitS = Math.max(error.retryAfterS ?? 0, 2 ** waits);
          if (!isPassing(error, isSafe) || waits === MOST_WAITS || waitS > LONGEST_WAIT_S) throw error;
          waits += 1;
          await this.#wait(error, waitS, signal);
        }
      }
    }
  }

  async #wait(refusal: ServiceError, waitS: number, signal: AbortSignal | undefined): Promise<void> {
    this.#waiting += 1;
    this.listener?.onWaiting(refusal, waitS);
    try {
      await pause(1000 * waitS, signal);
    } finally {
      this.#waiting -= 1;
      if (this.#waiting === 0) this.listener?.onWaiting(null, 0);
    }
  }
}

/** Whether a request is refused for a while: too many come, or all workers are busy. */
function isPassing({ status, retryAfterS }: ServiceError, isSafe: boolean): boolean {
  return retryAfterS !== null && (status === 429 || (status === 503 && isSafe));
}

function pause(ms: number, signal: AbortSignal | undefined): Promise<void> {
  return new Promise((resolve, reject) => {
    const giveUp = (): void => {
      clearTimeout(timer);
      reject(new DOMException("The request was given up.", "AbortError"));
    };
    const timer = setTimeout(() => {
      signal?.removeEventListener("abort", giveUp);
      resolve();
    }, ms);
    if (signal?.aborted) giveUp();
    else signal?.addEventListener("abort", giveUp, { once: true });
  });
}
