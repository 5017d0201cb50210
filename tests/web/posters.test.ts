import { MOST_POSTERS, Posters, type Poster } from "@/editor/posters";

/** A browser's storage of some keys. */
function shelf(): Pick<Storage, "getItem" | "setItem" | "removeItem"> & { readonly kept: Map<string, string> } {
  const kept = new Map<string, string>();
  return {
    kept,
    getItem: (key) => kept.get(key) ?? null,
    setItem: (key, value) => void kept.set(key, value),
    removeItem: (key) => void kept.delete(key),
  };
}

function poster(shot: string, camera: string | null = "/cam", more: Partial<Poster> = {}): Poster {
  return { who: "ann", shot, camera, aspect: 2, lens: "a lens", image: `data:image/jpeg,${shot}`, ...more };
}

describe("posters", () => {
  it("are there on the next visit, the last one of a camera", () => {
    const storage = shelf();
    const posters = new Posters(storage);
    posters.keep(poster("night"));
    posters.keep(poster("night", "/wide", { lens: "a wide lens" }));
    posters.keep(poster("night", "/cam", { lens: "another lens" }));
    const later = new Posters(storage);
    expect(later.find("ann", "night", "/wide")?.lens).toBe("a wide lens");
    expect(later.find("ann", "night", "/cam")?.lens).toBe("another lens");
    expect(later.find("ann", "night", null)?.camera).toBe("/cam"); // the one seen last
    expect(later.find("ann", "day", null)).toBeNull();
  });

  it("are seen by nobody else, and by nobody once all are forgotten", () => {
    const storage = shelf();
    const posters = new Posters(storage);
    posters.keep(poster("night"));
    expect(posters.find("bob", "night", null)).toBeNull();
    posters.keep(poster("day"));
    posters.forget("night");
    expect([posters.find("ann", "night", null), posters.find("ann", "day", null)?.shot]).toEqual([null, "day"]);
    posters.clear();
    expect([...storage.kept]).toEqual([]);
  });

  it("are few, the oldest goes first", () => {
    const posters = new Posters(null);
    for (let at = 0; at <= MOST_POSTERS; at += 1) posters.keep(poster(`shot${at}`));
    expect(posters.find("ann", "shot0", null)).toBeNull();
    expect(posters.find("ann", "shot1", null)).not.toBeNull();
  });

  it("are none where what is kept is something else, or nothing can be kept", () => {
    const storage = shelf();
    for (const text of ["", "{}", "null", '[{"who":"ann"}, 1, null]', "[{}"]) {
      storage.kept.set("pullfocus.posters", text);
      expect(new Posters(storage).find("ann", "night", null)).toBeNull();
    }
    const setItem = (): void => {
      throw new DOMException("full", "QuotaExceededError");
    };
    const posters = new Posters({ ...shelf(), setItem });
    posters.keep(poster("night"));
    expect(posters.find("ann", "night", null)?.shot).toBe("night");
  });
});
