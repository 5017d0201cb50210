/** Small pictures of shots that were open here before, for the moment until the first picture of one is there. */

/** A picture of a shot as it was seen last. */
export interface Poster {
  /** Id of who saw it. */
  readonly who: string;
  /** Id of the shot. */
  readonly shot: string;
  /** Prim path of the camera; null for a view without one. */
  readonly camera: string | null;
  /** Width over height. */
  readonly aspect: number;
  /** The lens in words. */
  readonly lens: string;
  /** A data URL. */
  readonly image: string;
}

const KEY = "pullfocus.posters";
/** More shots than anybody goes between; of about 10 kB each. */
export const MOST_POSTERS = 24;

export class Posters {
  readonly #storage: Pick<Storage, "getItem" | "setItem" | "removeItem"> | null;
  /** The newest first. */
  #all: readonly Poster[];

  /** @param storage keeps them between visits; null keeps them for this one. */
  constructor(storage: Pick<Storage, "getItem" | "setItem" | "removeItem"> | null) {
    this.#storage = storage;
    this.#all = read(storage);
  }

  /** The poster of a shot through a camera; with null through the one that it was seen through last. */
  find(who: string, shot: string, camera: string | null): Poster | null {
    const isOf = (poster: Poster): boolean => poster.who === who && poster.shot === shot;
    return this.#all.find((poster) => isOf(poster) && (camera === null || poster.camera === camera)) ?? null;
  }

  /** Keeps a poster in place of the one before. */
  keep(poster: Poster): void {
    const others = this.#all.filter(
      ({ who, shot, camera }) => who !== poster.who || shot !== poster.shot || camera !== poster.camera,
    );
    this.#set([poster, ...others].slice(0, MOST_POSTERS));
  }

  /** Forgets a shot that is gone. */
  forget(shot: string): void {
    this.#set(this.#all.filter((poster) => poster.shot !== shot));
  }

  /** Forgets all, as when somebody signs out. */
  clear(): void {
    this.#set([]);
  }

  #set(all: readonly Poster[]): void {
    this.#all = all;
    try {
      if (all.length === 0) this.#storage?.removeItem(KEY);
      else this.#storage?.setItem(KEY, JSON.stringify(all));
    } catch {
      // The storage is full or blocked: they last as long as the page.
    }
  }
}

function read(storage: Pick<Storage, "getItem"> | null): readonly Poster[] {
  try {
    const kept: unknown = JSON.parse(storage?.getItem(KEY) ?? "[]");
    return Array.isArray(kept) ? kept.filter(isPoster) : [];
  } catch {
    return [];
  }
}

function isPoster(kept: unknown): kept is Poster {
  if (typeof kept !== "object" || kept === null) return false;
  const { who, shot, camera, aspect, lens, image } = kept as Record<keyof Poster, unknown>;
  return (
    [who, shot, lens].every((text) => typeof text === "string") &&
    (camera === null || typeof camera === "string") &&
    typeof aspect === "number" &&
    aspect > 0 &&
    typeof image === "string" &&
    image.startsWith("data:image/")
  );
}
