/** Tells when renders may have changed. */

/** A source of changes; between `start` and `stop` it calls `onChange` for each. */
export interface RenderChanges {
  start(onChange: () => void): void;
  stop(): void;
}

/** Time between two looks, ms. */
export const LOOK_MS = 2000;

/** Part of the document that tells whether the page is seen. */
type Seen = Pick<Document, "visibilityState" | "addEventListener" | "removeEventListener">;

/** Takes it that renders change every two seconds, while the page is seen. */
export class PolledChanges implements RenderChanges {
  readonly #document: Seen;
  #timer: ReturnType<typeof setInterval> | undefined;
  #onChange: () => void = () => undefined;

  constructor(document: Seen) {
    this.#document = document;
  }

  start(onChange: () => void): void {
    this.stop();
    this.#onChange = onChange;
    this.#timer = setInterval(this.#look, LOOK_MS);
    this.#document.addEventListener("visibilitychange", this.#look);
  }

  stop(): void {
    clearInterval(this.#timer);
    this.#document.removeEventListener("visibilitychange", this.#look);
  }

  readonly #look = (): void => {
    if (this.#document.visibilityState === "visible") this.#onChange();
  };
}

/** Part of an `EventSource` that is used. */
type Source = Pick<EventSource, "addEventListener" | "close" | "readyState">;

/** Shortest time between two changes that are told, ms: frames may end faster than a list is read. */
export const TOLD_MS = 400;
/** Topics of the service's events that renders change with; `gap` and `open` mean that some may have been missed. */
const TOLD_BY = ["renders", "tasks", "gap", "open"];
const CLOSED = 2;

/** Hears of changes from the service's events; looks every two seconds where it takes no more readers. */
export class ToldChanges implements RenderChanges {
  readonly #connect: () => Source;
  readonly #otherwise: RenderChanges;
  #source: Source | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #isDue = false;

  constructor(connect: () => Source, otherwise: RenderChanges) {
    [this.#connect, this.#otherwise] = [connect, otherwise];
  }

  start(onChange: () => void): void {
    this.stop();
    const source = this.#connect();
    this.#source = source;
    for (const topic of TOLD_BY) {
      source.addEventListener(topic, () => {
        if (source === this.#source) this.#tell(onChange);
      });
    }
    source.addEventListener("error", () => {
      if (source !== this.#source || source.readyState !== CLOSED) return; // else the browser connects again
      this.stop();
      this.#otherwise.start(onChange);
    });
  }

  stop(): void {
    this.#source?.close();
    this.#source = null;
    clearTimeout(this.#timer);
    [this.#timer, this.#isDue] = [undefined, false];
    this.#otherwise.stop();
  }

  #tell(onChange: () => void): void {
    if (this.#timer !== undefined) {
      this.#isDue = true;
      return;
    }
    onChange();
    this.#timer = setTimeout(() => {
      this.#timer = undefined;
      if (!this.#isDue) return;
      this.#isDue = false;
      this.#tell(onChange);
    }, TOLD_MS);
  }
}
