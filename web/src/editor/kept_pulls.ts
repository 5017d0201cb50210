/** Marks and takes of pulls, which the browser keeps for each shot and person; the service has no place for them. */

import { keptNotes, notesOf, type PullNotes } from "../model/take";

const KEY = "pullfocus.pulls";
/** Shots of each person of which they are kept; the oldest go. */
export const MOST_SHOTS = 24;

type Store = Pick<Storage, "getItem" | "setItem">;

interface Kept {
  readonly who: string;
  readonly shot: string;
  readonly notes: unknown;
}

export class KeptPulls {
  readonly #storage: Store | null;
  readonly #who: string;

  /** @param storage keeps them between visits; null keeps nothing. */
  constructor(storage: Store | null, who: string) {
    [this.#storage, this.#who] = [storage, who];
  }

  /** What is kept of a shot; null for nothing. */
  find(shot: string): PullNotes | null {
    const kept = this.#all().find((one) => this.#isOf(one, shot));
    return kept ? notesOf(kept.notes) : null;
  }

  /** Keeps the notes of a shot in place of those before, and returns whether it could. Where there is no room, older shots go. */
  keep(shot: string, notes: PullNotes): boolean {
    const others = this.#all().filter((one) => !this.#isOf(one, shot));
    const own = others.filter(({ who }) => who === this.#who).slice(0, MOST_SHOTS - 1);
    let all = others.filter((one) => one.who !== this.#who || own.includes(one));
    const kept = { who: this.#who, shot, notes: keptNotes(notes) };
    while (!this.#set([kept, ...all])) {
      if (all.length === 0) return false;
      all = all.slice(0, -1);
    }
    return true;
  }

  /** Forgets a shot that is gone, whoever pulled its focus; what it returns puts that back. */
  forget(shot: string): () => void {
    const all = this.#all();
    const gone = all.filter((one) => one.shot === shot);
    if (gone.length > 0) this.#set(all.filter((one) => one.shot !== shot));
    return () => {
      if (gone.length > 0) this.#set([...gone, ...this.#all().filter((one) => one.shot !== shot)]);
    };
  }

  #isOf(kept: Kept, shot: string): boolean {
    return kept.who === this.#who && kept.shot === shot;
  }

  #set(all: readonly Kept[]): boolean {
    if (!this.#storage) return false;
    try {
      this.#storage.setItem(KEY, JSON.stringify(all));
      return true;
    } catch {
      return false; // it is full or blocked
    }
  }

  /** What is kept; read anew each time, since other windows keep theirs there, too. */
  #all(): readonly Kept[] {
    try {
      const kept: unknown = JSON.parse(this.#storage?.getItem(KEY) ?? "[]");
      return Array.isArray(kept) ? kept.filter(isKept) : [];
    } catch {
      return [];
    }
  }
}

function isKept(json: unknown): json is Kept {
  if (typeof json !== "object" || json === null) return false;
  const { who, shot } = json as Record<keyof Kept, unknown>;
  return typeof who === "string" && typeof shot === "string";
}
