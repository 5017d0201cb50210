/** What the page waits for: each wait has a name, and most can be stopped, which puts all back as it was before. */

import { effect, signal, untracked, type ReadonlySignal, type Signal } from "@preact/signals";

export type WaitKind =
  "opening" | "upload" | "download" | "frames" | "pick" | "picture" | "meter" | "curve" | "lens" | "camera" | "edit";

/** Waits that a person has asked for by themselves, so that Escape stops them. */
const ASKED: readonly WaitKind[] = ["opening", "upload", "download", "frames", "pick"];

export function isAsked(kind: WaitKind): boolean {
  return ASKED.includes(kind);
}

export interface Wait {
  readonly kind: WaitKind;
  /** What is done: "Metering". */
  readonly name: Signal<string>;
  /** Share that is done, 0 to 1; null where nobody tells. */
  readonly progress: ReadonlySignal<number | null>;
  /** When it began, by the clock of the page, ms. */
  readonly beganMs: number;
  /** Gives it up; null where it cannot be taken back. */
  readonly stop: (() => void) | null;
}

/** What a wait may have beside its kind and name. */
interface Terms {
  readonly stop?: (() => void) | null;
  readonly progress?: ReadonlySignal<number | null>;
}

/** What is done in a wait can tell how far it is. */
export interface Told {
  readonly name: Signal<string>;
  readonly progress: Signal<number | null>;
}

export class Waits {
  readonly #all = signal<readonly Wait[]>([]);

  /** The newest wait of a kind; null where there is none. */
  of(kind: WaitKind): Wait | null {
    return this.#all.value.findLast((wait) => wait.kind === kind) ?? null;
  }

  begin(kind: WaitKind, name: string, { stop = null, progress = signal(null) }: Terms = {}): Wait {
    const wait = { kind, name: signal(name), progress, beganMs: performance.now(), stop };
    this.#all.value = [...this.#all.peek(), wait];
    return wait;
  }

  end(wait: Wait): void {
    this.#all.value = this.#all.peek().filter((other) => other !== wait);
  }

  /**
   * Waits for something that can be stopped.
   *
   * @param act does it; what it is given is aborted when the wait is stopped.
   * @throws what `act` throws, or at once an AbortError where it is stopped.
   */
  async run<Result>(
    kind: WaitKind,
    name: string,
    act: (abort: AbortSignal, told: Told, wait: Wait) => Promise<Result>,
  ): Promise<Result> {
    const abort = new AbortController();
    const stopped = new Promise<never>((_, reject) => {
      abort.signal.addEventListener("abort", () => {
        reject(new DOMException(`${name} was stopped.`, "AbortError"));
      });
    });
    const progress = signal<number | null>(null);
    const stop = (): void => {
      abort.abort();
    };
    const wait = this.begin(kind, name, { stop, progress });
    try {
      return await Promise.race([act(abort.signal, { name: wait.name, progress }, wait), stopped]);
    } finally {
      this.end(wait);
    }
  }

  /**
   * Waits while something is under way that has its own ways to begin and to stop.
   *
   * @param name of what is under way; another name is another wait, and null is none.
   * @returns what ends that.
   */
  follow(kind: WaitKind, name: ReadonlySignal<string | null>, terms: Terms = {}): () => void {
    return effect(() => {
      const now = name.value;
      if (now === null) return undefined;
      const wait = untracked(() => this.begin(kind, now, terms));
      return () => {
        this.end(wait);
      };
    });
  }

  /** The newest of the waits that a person has asked for and can stop; null where there is none. */
  get newest(): Wait | null {
    return this.#all.value.findLast(({ kind, stop }) => stop !== null && isAsked(kind)) ?? null;
  }

  /** Stops the newest of the waits that a person has asked for; returns whether there was one. */
  stopNewest(): boolean {
    const wait = this.newest;
    wait?.stop?.();
    return wait !== null;
  }
}
