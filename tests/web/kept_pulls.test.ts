import { KeptPulls, MOST_SHOTS } from "@/editor/kept_pulls";
import { NO_NOTES, type PullNotes } from "@/model/take";

/** A browser's storage of one key, which takes texts of up to so many characters. */
class Store {
  kept: string | null = null;
  most = Infinity;
  getItem(): string | null {
    return this.kept;
  }
  setItem(_key: string, value: string): void {
    if (value.length > this.most) throw new Error("It is full.");
    this.kept = value;
  }
}

const notes = (punchIn: number): PullNotes => ({ ...NO_NOTES, punchIn });

describe("pulls that are kept", () => {
  it("are those of the last shots of each person", () => {
    const store = new Store();
    const [ann, bob] = [new KeptPulls(store, "ann"), new KeptPulls(store, "bob")];
    bob.keep("old", notes(1));
    for (let at = 0; at <= MOST_SHOTS; at += 1) ann.keep(`shot ${at}`, notes(at));
    expect([bob.find("old")?.punchIn, ann.find("shot 0"), ann.find("shot 1")?.punchIn]).toEqual([1, null, 1]);
  });

  it("take the room of older shots, and say where there is none", () => {
    const store = new Store();
    const kept = new KeptPulls(store, "ann");
    expect(kept.keep("one", notes(1))).toBe(true);
    store.most = (store.kept ?? "").length + 5;
    expect(kept.keep("two", notes(2))).toBe(true);
    expect([kept.find("one"), kept.find("two")?.punchIn]).toEqual([null, 2]);
    store.most = 20;
    expect(kept.keep("three", notes(3))).toBe(false);
    expect(kept.find("two")?.punchIn).toBe(2);
    expect(new KeptPulls(null, "ann").keep("one", notes(1))).toBe(false);
  });

  it("are forgotten with their shot", () => {
    const store = new Store();
    const [ann, bob] = [new KeptPulls(store, "ann"), new KeptPulls(store, "bob")];
    ann.keep("one", notes(1));
    ann.keep("two", notes(2));
    bob.keep("one", notes(3));
    const putBack = ann.forget("one");
    expect([ann.find("one"), ann.find("two")?.punchIn, bob.find("one")]).toEqual([null, 2, null]);
    putBack();
    expect([ann.find("one")?.punchIn, ann.find("two")?.punchIn, bob.find("one")?.punchIn]).toEqual([1, 2, 3]);
  });
});
