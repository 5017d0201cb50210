/**
 * Loads one thing after another and keeps up with the newest request.
 *
 * At most a few requests are in flight. Of those that wait only the newest is kept. A result that is older than one already
 * delivered is dropped, and the requests that could only bring such a result are aborted.
 */

export interface Queued<Request> {
  readonly request: Request;
  /** Aborted as soon as something newer is requested: slow, and of use only if nothing newer is. */
  readonly disposable?: boolean;
}

interface Flight<Request> extends Queued<Request> {
  readonly serial: number;
  readonly abort: AbortController;
}

export interface NewestWinsOptions<Request, Result> {
  load(request: Request, signal: AbortSignal): Promise<Result>;
  onResult(result: Result, request: Request): void;
  onError(error: unknown, request: Request): void;
  /** Takes whether anything is in flight, each time that changes. */
  onBusy?(isBusy: boolean): void;
  /** Waits before each request is sent. */
  pause?(): Promise<void>;
  mostInFlight?: number;
}

export class NewestWins<Request, Result> {
  readonly #options: NewestWinsOptions<Request, Result>;
  readonly #most: number;
  #flights: Flight<Request>[] = [];
  #waiting: Queued<Request> | null = null;
  #serial = 0;
  #delivered = 0;

  constructor(options: NewestWinsOptions<Request, Result>) {
    this.#options = options;
    this.#most = options.mostInFlight ?? 2;
  }

  /** Whether another request would be sent at once. */
  get free(): boolean {
    return this.#flights.length < this.#most;
  }

  load(request: Request, { disposable = false } = {}): void {
    this.#abort((flight) => flight.disposable === true);
    const queued = { request, disposable };
    if (this.free) this.#start(queued);
    else this.#waiting = queued;
  }

  /** Delivers a result that is there already; requests in flight would bring older ones. */
  take(result: Result, request: Request): void {
    this.clear();
    this.#options.onResult(result, request);
  }

  /** Aborts all requests in flight and drops the one that waits. */
  clear(): void {
    this.#waiting = null;
    this.#abort(() => true);
  }

  #start(queued: Queued<Request>): void {
    this.#serial += 1;
    const flight = { ...queued, serial: this.#serial, abort: new AbortController() };
    this.#setFlights([...this.#flights, flight]);
    void this.#fly(flight);
  }

  async #fly(flight: Flight<Request>): Promise<void> {
    try {
      if (this.#options.pause) await this.#options.pause();
      if (flight.abort.signal.aborted) return;
      const result = await this.#options.load(flight.request, flight.abort.signal);
      if (this.#remove(flight) && flight.serial > this.#delivered) {
        this.#delivered = flight.serial;
        this.#abort((other) => other.serial < flight.serial);
        this.#options.onResult(result, flight.request);
      }
    } catch (error) {
      if (this.#remove(flight)) this.#options.onError(error, flight.request);
    }
    this.#next();
  }

  /** Removes a flight from the list; false where it was aborted before. */
  #remove(flight: Flight<Request>): boolean {
    const isListed = this.#flights.includes(flight);
    this.#setFlights(this.#flights.filter((other) => other !== flight));
    return isListed;
  }

  #setFlights(flights: Flight<Request>[]): void {
    const was = this.#flights.length > 0;
    this.#flights = flights;
    if (was !== flights.length > 0) this.#options.onBusy?.(!was);
  }

  #next(): void {
    if (this.#waiting && this.free) {
      const next = this.#waiting;
      this.#waiting = null;
      this.#start(next);
    }
  }

  #abort(which: (flight: Flight<Request>) => boolean): void {
    const [aborted, kept] = [this.#flights.filter(which), this.#flights.filter((flight) => !which(flight))];
    this.#setFlights(kept);
    for (const flight of aborted) flight.abort.abort();
  }
}
