import { Editor } from "@/editor/editor";
import type { Shot, TrashedShot } from "@/model/shot";
import { errorOf } from "@/net/errors";
import type { Download } from "@/net/service";
import { FakeService, SHOT, turn } from "./fake_service";

const TWO_CAMERAS: Shot = {
  ...SHOT,
  cameras: [
    { path: "/cam", aspect: 2 },
    { path: "/wide", aspect: 2 },
  ],
};

/** An editor whose requests to open a shot are answered when the test says so, the first one first. */
function opening(): { fake: FakeService; editor: Editor; answer: () => Promise<void>; refuse: () => Promise<void> } {
  const fake = new FakeService();
  const waiting: { resolve: (shot: Shot) => void; reject: (error: Error) => void }[] = [];
  fake.open = () => new Promise((resolve, reject) => waiting.push({ resolve, reject }));
  const editor = new Editor(fake.service, () => undefined);
  return {
    fake,
    editor,
    answer: () => {
      waiting.shift()?.resolve(TWO_CAMERAS);
      return turn();
    },
    refuse: () => {
      waiting.shift()?.reject(errorOf(500, { code: "broken", detail: "It is broken." }));
      return turn();
    },
  };
}

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

describe("a camera that is chosen", () => {
  it("is the last one, however fast another was chosen before", async () => {
    const { editor, answer } = opening();
    void editor.open("demo");
    await answer();
    void editor.lookThrough("/wide");
    void editor.lookThrough("/cam");
    void editor.lookThrough("/wide");
    expect(editor.opening.value).toEqual({ shot: "demo", camera: "/wide" });
    for (let count = 0; count < 3; count += 1) await answer();
    expect([editor.session.value?.camera, editor.opening.value]).toEqual(["/wide", null]);
  });

  it("and cannot be opened leaves the one before, and nobody hears of one that was chosen before it", async () => {
    const { editor, answer, refuse } = opening();
    void editor.open("demo");
    await answer();
    void editor.lookThrough("/wide");
    void editor.lookThrough("/wide");
    await refuse();
    expect([editor.complaint.value, editor.opening.value]).toEqual([null, { shot: "demo", camera: "/wide" }]);
    await refuse();
    expect(editor.complaint.value?.message).toBe("It is broken.");
    expect([editor.session.value?.camera, editor.opening.value]).toEqual(["/cam", null]);
  });
});

describe("trying again", () => {
  it("repeats what failed", async () => {
    const { fake, editor, answer, refuse } = opening();
    void editor.open("demo", "/wide", 7);
    await refuse();
    expect(editor.complaint.value?.remedy).toBe("retry");
    editor.retry();
    expect(editor.complaint.value).toBeNull();
    await answer();
    expect([editor.session.value?.camera, editor.session.value?.playhead.time.value]).toEqual(["/wide", 7]);

    fake.failing = "removePoint";
    await editor.session.value?.document.edit("a", [{ type: "removePoint", name: "a" }]);
    expect([editor.complaint.value?.message, fake.made]).toEqual(["No removePoint.", []]);
    fake.failing = null;
    editor.retry();
    await turn();
    expect(fake.made).toEqual([[{ type: "removePoint", name: "a" }]]);
  });

  it("reads the lists of lenses and films that could not be read, and opening a shot does not hide that", async () => {
    const fake = new FakeService();
    const editor = new Editor(fake.service, () => undefined);
    const lenses = vi.spyOn(fake, "lenses").mockRejectedValue(errorOf(500, { code: "broken", detail: "No lenses." }));
    await editor.start(null, null, null);
    expect([editor.session.value?.shot.id, editor.complaint.value?.message]).toEqual(["demo", "No lenses."]);
    lenses.mockRestore();
    editor.retry();
    await turn();
    expect([editor.lenses.value.length, editor.libraries.value.films, editor.complaint.value]).toEqual([1, [], null]);
  });

  it("opens what the address says where the shots could not be listed", async () => {
    const fake = new FakeService();
    const editor = new Editor(fake.service, () => undefined);
    const shots = vi.spyOn(fake, "shots").mockRejectedValue(errorOf(500, { code: "broken", detail: "No shots." }));
    await editor.start("demo", "/cam", 9);
    expect(editor.session.value).toBeNull();
    shots.mockRestore();
    editor.retry();
    await turn();
    expect(editor.session.value?.playhead.time.value).toBe(9);
  });
});

it("a download waits for the edits under way", async () => {
  const { fake, editor, answer } = opening();
  void editor.open("demo");
  await answer();
  let made = (): void => undefined;
  fake.gate = () => new Promise((resolve) => (made = resolve));
  void editor.session.value?.document.edit("a", [{ type: "removePoint", name: "a" }]);
  const saved: number[] = [];
  const make = (): Promise<Download> => Promise.resolve({ blob: new Blob(), name: "edits.usda" });
  const exported = editor.export("Edit layer", make, () => saved.push(fake.made.length));
  await turn();
  expect([saved, editor.waits.of("download")?.name.value]).toEqual([[], "Making Edit layer"]);
  made();
  await exported;
  expect([saved, editor.waits.of("download")]).toEqual([[1], null]);
});

/** An editor with a shot without a camera open. */
async function framed(): Promise<{ fake: FakeService; editor: Editor }> {
  const fake = new FakeService();
  fake.shot = { ...SHOT, cameras: [], cameraPaths: [], defaultCamera: null };
  const editor = new Editor(fake.service, () => undefined);
  await editor.open("demo", null, 7);
  await turn();
  return { fake, editor };
}

describe("a shot without a camera", () => {
  it("gets one from its view at the present time, which is looked through from then on", async () => {
    const { fake, editor } = await framed();
    expect(editor.session.value?.camera).toBeNull();
    editor.createCamera();
    await turn();
    expect(fake.made).toEqual([[{ type: "createCamera", time: 7 }]]);
    const session = editor.session.value;
    expect([session?.camera, session?.document.hasLens, session?.playhead.time.value]).toEqual(["/main_cam", true, 7]);
    expect([session?.document.undoLabel.value, editor.complaint.value]).toEqual(["Create a camera", null]);
  });

  it("is framed again once that is undone, and has its camera again once it is redone", async () => {
    const { fake, editor } = await framed();
    const read = vi.spyOn(fake, "focusPoints");
    editor.createCamera();
    await turn();
    await editor.session.value?.document.undo();
    await turn();
    expect([editor.session.value?.camera, editor.session.value?.document.hasLens]).toEqual([null, false]);
    const reads = read.mock.calls.length;
    await editor.session.value?.document.catchUp();
    expect([read.mock.calls.length, editor.complaint.value]).toEqual([reads, null]);
    await editor.session.value?.document.redo();
    await turn();
    expect([editor.session.value?.camera, editor.complaint.value]).toEqual(["/main_cam", null]);
  });

  it("is looked at through the camera that somebody else has created", async () => {
    const { fake, editor } = await framed();
    const before = editor.session.value;
    fake.othersDo({ type: "setCamera", values: { fStop: 4 } });
    await editor.catchUp();
    expect(editor.session.value).toBe(before);
    fake.othersDo({ type: "createCamera" });
    await editor.catchUp();
    await turn();
    expect(editor.session.value?.camera).toBe("/main_cam");
  });

  it("and whose camera could not be created stays as it is, with the reason", async () => {
    const { fake, editor } = await framed();
    fake.failing = "createCamera";
    editor.createCamera();
    await turn();
    expect([editor.session.value?.camera, editor.complaint.value?.message]).toEqual([null, "No createCamera."]);
  });
});

it("takes and marks go with a shot that is deleted, and come back with it", async () => {
  const kept = new Map<string, string>();
  vi.stubGlobal("localStorage", {
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, value: string) => void kept.set(key, value),
    removeItem: (key: string) => void kept.delete(key),
  });
  const fake = new FakeService();
  const gone = { removeShot: () => Promise.resolve(), restore: () => Promise.resolve() };
  const editor = new Editor(Object.assign(fake, gone).service, () => undefined);
  const punch = (): number | null | undefined => editor.session.value?.desk.notes.value.punchIn;
  await editor.open(SHOT.id);
  editor.session.value?.desk.punch({ punchIn: 7 });
  await editor.open(SHOT.id);
  expect(punch()).toBe(7);
  await editor.remove(SHOT.id);
  await editor.open(SHOT.id);
  expect(punch()).toBeNull();
  const entry = { id: "t", shot: SHOT.id } as TrashedShot;
  await editor.restore(entry);
  expect(punch()).toBe(7);
});

it("a note that is written goes on where its session is replaced", async () => {
  const { editor, fake } = await framed();
  const notes = editor.session.value?.frameNotes;
  notes?.begin();
  notes?.write("hold");
  editor.createCamera();
  await turn();
  await turn();
  expect(fake.made).toHaveLength(1);
  expect(editor.session.value?.frameNotes).not.toBe(notes);
  expect(editor.session.value?.frameNotes.draft.value?.text).toBe("hold");
  expect(editor.session.value?.frameNotes.isShown.value).toBe(true);
});
