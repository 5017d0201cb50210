import { effect } from "@preact/signals";
import type { FrameNote } from "@/model/frame_notes";
import { FakeService } from "./fake_service";
import { LINE, note, notesOf, type Opened } from "./noted_session";

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", vi.fn());
});
afterEach(() => {
  vi.unstubAllGlobals();
});

/** A note that was opened, and that somebody else has changed since. */
async function contested(values: Partial<FrameNote>): Promise<Opened & { readonly fake: FakeService }> {
  const fake = new FakeService();
  const opened = notesOf(fake);
  fake.othersDo({ type: "addNote", note: { id: "a", time: 7, text: "as it was" } });
  await opened.notes.read();
  const [listed] = opened.notes.list.value;
  if (listed) opened.notes.alter(listed);
  fake.othersDo({ type: "editNote", id: "a", values });
  await opened.notes.read();
  return { ...opened, fake };
}

describe("a note that somebody else changes meanwhile", () => {
  it("is not overwritten unseen, and is kept by another try", async () => {
    const { fake, notes, document, fail } = await contested({ text: "theirs" });
    notes.write("mine");
    notes.keep();
    await document.idle();
    expect(fake.made).toEqual([]);
    expect([notes.draft.value?.text, notes.list.value[0]?.text]).toEqual(["mine", "theirs"]);
    expect(fail.mock.calls[0]?.[0]).toMatchObject({ status: 412 });
    (fail.mock.calls[0]?.[1] as () => void)();
    await document.idle();
    expect(fake.made).toEqual([[{ type: "editNote", id: "a", values: { text: "mine" } }]]);
    expect(fail).toHaveBeenCalledOnce();
  });

  it("is kept at once where the two have changed different things of it", async () => {
    const { fake, notes, document, fail } = await contested({ resolved: true, strokes: [LINE] });
    notes.write("mine");
    notes.keep();
    await document.idle();
    expect(fake.made).toEqual([[{ type: "editNote", id: "a", values: { text: "mine" } }]]);
    expect(fail).not.toHaveBeenCalled();
  });

  it("comes back over what they have made of it where the service has refused it", async () => {
    const fake = new FakeService();
    const { notes, document, fail } = notesOf(fake);
    fake.othersDo({ type: "addNote", note: { id: "a", time: 7, text: "as it was", strokes: [] } });
    await notes.read();
    notes.alter(notes.list.value[0] ?? note("none", 0));
    notes.write("mine");
    fake.othersDo({ type: "editNote", id: "a", values: { text: "theirs", strokes: [LINE] } });
    fake.failing = "editNote";
    notes.keep();
    await vi.waitFor(() => {
      expect(notes.draft.value).toMatchObject({ text: "mine", strokes: [LINE], opened: { text: "theirs" } });
    });
    fake.failing = null;
    (fail.mock.calls[0]?.[1] as () => void)();
    await document.idle();
    expect([notes.draft.value, fake.made.length]).toEqual([null, 1]);
  });
});

describe("edits that change no note", () => {
  it("have no notes read", async () => {
    const fake = new FakeService();
    const { notes, document } = notesOf(fake);
    const reading = vi.spyOn(fake, "frameNotes");
    await document.catchUp();
    effect(() => {
      notes.keepUp();
    });
    await document.edit("a", [{ type: "removePoint", name: "a" }]);
    fake.othersDo({ type: "removePoint", name: "b" });
    await document.catchUp();
    expect(reading).not.toHaveBeenCalled();
    fake.othersDo({ type: "addNote", note: { id: "a", time: 7, text: "theirs" } });
    await document.catchUp((await fake.history()).revision);
    expect(reading).toHaveBeenCalledOnce();
  });
});
