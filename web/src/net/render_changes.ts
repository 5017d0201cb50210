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
