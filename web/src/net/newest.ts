/**
 * Asks for one thing after another and keeps up with the newest.
 *
 * At most a few requests are in flight. While they are, only the newest of those that wait is kept. A result that is
 * older than one already delivered is dropped, and so are the requests that could only bring such a result.
 */

export interface Wanted<Request> {
  readonly request: Request;
  /** Slow and only worth having if nothing newer is wanted: aborted as soon as something is. */
  readonly disposable?: boolean;
}

interface Flight<Request> extends Wanted<Request> {
  readonly serial: number;
  readonly abort: AbortController;
}

export interface NewestWinsOptions<Request, Result> {
  load(request: Request, signal: AbortSignal): Promise<Result>;
  onResult(result: Result, request: Request): void;
  onError(error: unknown, request: Request): void;
  /** Called whenever the number of requests in flight or waiting changes. */
  onBusy?(busy: boolean): void;
  mostInFlight?: number;
}

export class NewestWins<Request, Result> {
  readonly #options: NewestWinsOptions<Request, Result>;
  readonly #most: number;
  #flights: Flight<Request>[] = [];
  #waiting: Wanted<Request> | null = null;
  #serial = 0;
  #delivered = 0;

  constructor(options: NewestWinsOptions<Request, Result>) {
    this.#options = options;
    this.#most = options.mostInFlight ?? 2;
  }

  /** Whether another request would go out at once. */
  get free(): boolean {
    return this.#flights.length < this.#most;
  }

  get busy(): boolean {
    return this.#flights.length > 0 || this.#waiting !== null;
  }

  want(wanted: Wanted<Request>): void {
    this.#abort((flight) => flight.disposable === true);
    if (this.free) this.#start(wanted);
    else this.#waiting = wanted;
    this.#options.onBusy?.(this.busy);
  }

  /** Aborts all that is in flight and forgets what waits. */
  clear(): void {
    this.#waiting = null;
    this.#abort(() => true);
    this.#options.onBusy?.(this.busy);
  }

  #start(wanted: Wanted<Request>): void {
    this.#serial += 1;
    const flight = { ...wanted, serial: this.#serial, abort: new AbortController() };
    this.#flights.push(flight);
    void this.#fly(flight);
  }

  async #fly(flight: Flight<Request>): Promise<void> {
    try {
      const result = await this.#options.load(flight.request, flight.abort.signal);
      if (this.#land(flight) && flight.serial > this.#delivered) {
        this.#delivered = flight.serial;
        this.#abort((other) => other.serial < flight.serial);
        this.#options.onResult(result, flight.request);
      }
    } catch (error) {
      if (this.#land(flight)) this.#options.onError(error, flight.request);
    }
    this.#next();
  }

  /** Takes a flight off the list; false where it was aborted and nobody waits for it. */
  #land(flight: Flight<Request>): boolean {
    const known = this.#flights.includes(flight);
    this.#flights = this.#flights.filter((other) => other !== flight);
    return known;
  }

  #next(): void {
    if (this.#waiting && this.free) {
      const next = this.#waiting;
      this.#waiting = null;
      this.#start(next);
    }
    this.#options.onBusy?.(this.busy);
  }

  #abort(which: (flight: Flight<Request>) => boolean): void {
    const [gone, kept] = [this.#flights.filter(which), this.#flights.filter((flight) => !which(flight))];
    this.#flights = kept;
    for (const flight of gone) flight.abort.abort();
  }
}
