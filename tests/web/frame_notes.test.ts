import { effect } from "@preact/signals";
import {
  drawnTo,
  keepDraft,
  nextTime,
  notesAt,
  pathOf,
  plainText,
  refusalOf,
  roomFor,
  seenThrough,
  withChanges,
  type Draft,
  type NoteList,
  type Stroke,
} from "@/model/frame_notes";
import type { Place } from "@/view/commands/command";
import { commandOf } from "@/view/commands/table";
import { kindOf } from "@/view/viewer/camera_gestures";
import { Waits } from "@/editor/waits";
import { FakeService, SHOT } from "./fake_service";
import { LINE, note, notesOf, type Opened } from "./noted_session";
import { opened } from "./pointed_session";

function draft(more: Partial<Draft>): Draft {
  return { id: "a", opened: null, time: 2, camera: null, text: "", strokes: [], ...more };
}

describe("notes", () => {
  it("are those of the camera and of all cameras", () => {
    const notes = [note("all", 1), note("own", 1, { camera: "/cam" }), note("other", 1, { camera: "/b" })];
    expect(seenThrough(notes, "/cam").map(({ id }) => id)).toEqual(["all", "own"]);
  });

  it("are found by their time", () => {
    const notes = [note("a", 2), note("b", 5)];
    expect(notesAt(SHOT.range, notes, 5)).toEqual([notes[1]]);
    const next = (time: number, way: 1 | -1): number | null => nextTime(SHOT.range, notes, time, way);
    expect([next(2, 1), next(2, -1), next(3, -1)]).toEqual([5, null, 2]);
  });

  it("off the frames are at the nearest one, so that the way goes on from there", () => {
    const notes = [note("before", -3), note("between", 5.4), note("after", 200)];
    expect(notesAt(SHOT.range, notes, 5)).toEqual([notes[1]]);
    const next = (time: number, way: 1 | -1): number | null => nextTime(SHOT.range, notes, time, way);
    expect([next(1, 1), next(5, 1), next(96, 1)]).toEqual([5, 96, null]);
    expect([next(96, -1), next(5, -1), next(1, -1)]).toEqual([5, 1, null]);
  });

  it("show changes before the service has made them", () => {
    const added = withChanges([note("b", 5)], keepDraft(draft({ text: " x ", camera: "/cam" }), null));
    expect(added.map(({ id, text, camera }) => [id, text, camera])).toEqual([
      ["a", "x", "/cam"],
      ["b", "b", null],
    ]);
    const resolved = withChanges(added, [{ type: "editNote", id: "b", values: { resolved: true, text: null } }]);
    expect(resolved[1]).toEqual(note("b", 5, { resolved: true }));
    expect(withChanges(resolved, [{ type: "deleteNote", id: "a" }])).toEqual([resolved[1]]);
  });
});

describe("what is kept of a draft", () => {
  it("is what was altered alone, and leaves what others have altered", () => {
    const opened = note("a", 2, { strokes: [LINE] });
    const same = draft({ opened, text: "a", strokes: [{ ...LINE, points: [[0.1, 0.2]] }] });
    const now = note("a", 2, { text: "theirs", strokes: [] });
    expect([keepDraft(same, opened), keepDraft(same, now)]).toEqual([[], []]);
    expect(keepDraft({ ...same, text: "mine" }, now)).toEqual([
      { type: "editNote", id: "a", values: { text: "mine" } },
    ]);
    const drawn = { ...same, strokes: [{ ...LINE, points: [[0.1, 0.3]] }] };
    expect(keepDraft(drawn, now)).toEqual([{ type: "editNote", id: "a", values: { strokes: drawn.strokes } }]);
  });

  it("brings a note that others have deleted back by what was altered of them", () => {
    const opened = note("a", 2);
    expect(keepDraft(draft({ opened, text: "a" }), null)).toEqual([]);
    expect(keepDraft(draft({ opened, text: "b" }), null)).toMatchObject([{ type: "addNote", note: { text: "b" } }]);
  });

  it("has text or a drawing, and plain text", () => {
    const empty = draft({ text: "  " });
    expect(refusalOf(empty)).toContain("text or a drawing");
    expect(refusalOf({ ...empty, strokes: [LINE] })).toBeNull();
    expect(plainText("a\r\nb\u0007c\u2028d")).toBe("a\nb c d");
  });
});

describe("a stroke", () => {
  it("goes on to places far enough, inside the picture, as long as there is room", () => {
    expect(drawnTo(LINE, [0.1001, 0.2], 2, 10)).toBe(LINE);
    expect(drawnTo(LINE, [1.5, -1], 2, 10).points).toEqual([
      [0.1, 0.2],
      [1, 0],
    ]);
    expect(drawnTo(LINE, [1, 0], 2, 1)).toBe(LINE);
  });

  it("has no room beside too many", () => {
    expect(roomFor([LINE])).toBe(3999);
    expect(roomFor(Array<Stroke>(100).fill(LINE))).toBe(0);
  });

  it("is a path, or a dot", () => {
    expect(pathOf(LINE, 2)).toBe("M0.2000 0.2000h0.0001");
    expect(pathOf({ ...LINE, points: [...LINE.points, [0.5, 1]] }, 2)).toBe("M0.2000 0.2000L1.0000 1.0000");
  });
});

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", vi.fn());
});

afterEach(() => {
  vi.unstubAllGlobals();
});

describe("the notes of a session", () => {
  it("are written, drawn, and kept by one edit that shows at once", async () => {
    const fake = new FakeService();
    const { notes, document } = notesOf(fake);
    notes.begin({ draws: true });
    notes.write("hold");
    notes.penDown([0.1, 0.1], 2);
    notes.penTo([0.5, 0.5], 2);
    expect(notes.strokesAt(7)).toHaveLength(1);
    notes.penUp();
    notes.keep();
    expect([notes.draft.value, notes.isDrawing.value]).toEqual([null, false]);
    expect(notes.here.value.map(({ text, strokes }) => [text, strokes.length])).toEqual([["hold", 1]]);
    await document.idle();
    expect(fake.made).toHaveLength(1);
    await vi.waitFor(() => {
      expect(notes.here.value.map(({ text }) => text)).toEqual(["hold"]);
    });
    expect([notes.strokesAt(7).length, notes.strokesAt(8).length]).toEqual([1, 0]);
  });

  it("are not begun or altered in place of what is written", () => {
    const { notes } = notesOf(new FakeService());
    notes.begin();
    notes.alter(note("a", 3));
    expect(notes.draft.value?.text).toBe("a");
    notes.write("mine");
    notes.isShown.value = false;
    notes.begin({ draws: true });
    notes.alter(note("b", 5));
    expect(notes.draft.value).toMatchObject({ id: "a", text: "mine" });
    expect([notes.isShown.value, notes.isDrawing.value, notes.calls.value]).toEqual([true, true, 2]);
  });
});

/** Notes of which a new one could not be kept, and what tries it again. */
async function refused(): Promise<Opened & { readonly fake: FakeService; readonly again: () => void }> {
  const fake = new FakeService();
  fake.failing = "addNote";
  const opened = notesOf(fake);
  opened.notes.begin();
  opened.notes.write("hold");
  opened.notes.keep();
  await vi.waitFor(() => {
    expect(opened.notes.draft.value?.text).toBe("hold");
  });
  return { ...opened, fake, again: opened.fail.mock.calls[0]?.[1] as () => void };
}

describe("notes that could not be kept", () => {
  it("come back as a draft where they could not be kept", async () => {
    const { notes, fail } = await refused();
    expect(notes.list.value).toEqual([]);
    expect(fail).toHaveBeenCalled();
  });

  it("are one note, kept by another try at the edit and from the draft", async () => {
    const { fake, notes, document, again } = await refused();
    notes.write("hold on");
    fake.failing = null;
    again();
    await document.idle();
    await notes.read();
    notes.keep();
    await document.idle();
    const [added, edited] = fake.made.flat();
    expect(added).toMatchObject({ type: "addNote", note: { text: "hold" } });
    expect(edited).toMatchObject({ type: "editNote", values: { text: "hold on" } });
  });

  it("have no draft once another try has kept it", async () => {
    const { fake, notes, document, again } = await refused();
    fake.failing = null;
    again();
    await document.idle();
    expect(notes.draft.value).toBeNull();
  });
});

describe("the list of notes", () => {
  it("is read again after an edit that was refused", async () => {
    const fake = new FakeService();
    fake.failing = "editNote";
    const { notes } = notesOf(fake);
    fake.othersDo({ type: "addNote", note: { id: "a", time: 7, text: "a" } });
    await notes.read();
    fake.othersDo({ type: "deleteNote", id: "a" });
    await Promise.all([notes.resolve(note("a", 7), true), notes.read()]);
    await vi.waitFor(() => {
      expect(notes.list.value).toEqual([]);
    });
  });

  it("is read again where others have changed them while an edit was read", async () => {
    const fake = new FakeService();
    const { notes, document } = notesOf(fake);
    effect(() => {
      notes.keepUp();
    });
    let answer: (notes: NoteList) => void = () => undefined;
    const reading = vi.spyOn(fake, "frameNotes");
    reading.mockImplementationOnce(() => new Promise((resolve) => (answer = resolve)));
    notes.begin();
    notes.write("mine");
    notes.keep();
    await document.idle();
    await vi.waitFor(() => {
      expect(reading).toHaveBeenCalledOnce();
    });
    fake.othersDo({ type: "addNote", note: { id: "a", time: 9, text: "theirs" } });
    await document.catchUp();
    answer({ notes: [], notesTag: "before" });
    await vi.waitFor(() => {
      expect(notes.list.value.map(({ text }) => text)).toEqual(["mine", "theirs"]);
    });
  });
});

describe("drawings", () => {
  it("are drawn on the picture of their frame and camera, at rest", () => {
    const { notes, playhead } = notesOf(new FakeService());
    notes.begin({ draws: true });
    expect([notes.drawsOn(7), notes.drawsOn(8)]).toEqual([true, false]);
    playhead.playing.value = true;
    expect(notes.drawsOn(7)).toBe(false);
    playhead.playing.value = false;
    notes.draw(false);
    expect(notes.drawsOn(7)).toBe(false);
  });

  it("go on in the next session, and are drawn through their camera alone", () => {
    const { notes } = notesOf(new FakeService());
    const cameraPaths = ["/cam", "/wide"];
    const next = notesOf(new FakeService(), { ...SHOT, cameraPaths }, "/wide").notes;
    notes.begin({ draws: true });
    notes.write("hold");
    next.follow(notes);
    next.draw(true);
    expect([next.draft.value?.camera, next.isShown.value, next.isDrawing.value]).toEqual(["/cam", true, false]);
    const last = notesOf(new FakeService(), { ...SHOT, cameraPaths: ["/wide"] }, "/wide").notes;
    last.follow(notes);
    last.draw(true);
    expect([last.draft.value?.camera, last.isDrawing.value]).toEqual(["/wide", true]);
  });

  it("lose the last stroke by undo", () => {
    const { notes } = notesOf(new FakeService());
    notes.begin({ draws: true });
    for (const x of [0.1, 0.5]) {
      notes.penDown([x, 0.1], 2);
      notes.penUp();
    }
    notes.undoStroke();
    expect(notes.draft.value?.strokes).toHaveLength(1);
    notes.cancel();
    expect(notes.strokesAt(7)).toEqual([]);
  });
});

describe("a session whose pointer draws", () => {
  it("undoes strokes alone by Ctrl Z, and moves no camera", async () => {
    const { session } = await opened();
    await session.document.edit("a", [{ type: "removePoint", name: "a" }]);
    const editor = { waits: new Waits() } as unknown as Place["editor"];
    const undo = { key: "z", code: "KeyZ", ctrlKey: true, metaKey: false, shiftKey: false, altKey: false };
    const drag = { ...undo, ctrlKey: false, altKey: true, button: 0, pointerType: "mouse", isPrimary: true };
    const meant = (): unknown => [
      commandOf(undo, { editor, session, isInTimeline: false })?.name,
      kindOf(drag, session),
    ];
    expect(meant()).toEqual(["Undo", "orbit"]);
    session.frameNotes.begin({ draws: true });
    expect(meant()).toEqual([undefined, null]);
    session.frameNotes.penDown([0.1, 0.1], 2);
    session.frameNotes.penUp();
    expect(meant()).toEqual(["Take the last stroke away", null]);
  });
});
