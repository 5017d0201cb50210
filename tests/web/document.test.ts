import { signal } from "@preact/signals";
import { ShotDocument } from "@/editor/document";
import type { Change, Changes } from "@/model/changes";
import { complaintOf } from "@/net/errors";
import { FakeService, SHOT, turn } from "./fake_service";
import { point } from "./points";

function setStop(fStop: number): Change {
  return { type: "setCamera", values: { fStop } };
}

function toStop(fStop: number): Changes {
  return [setStop(fStop)];
}

function opened(): { fake: FakeService; document: ShotDocument; failed: unknown[] } {
  const fake = new FakeService();
  const failed: unknown[] = [];
  const document = new ShotDocument(fake.service, SHOT, "/cam", signal(1), (error) => failed.push(error));
  return { fake, document, failed };
}

describe("edits", () => {
  it("are sent one after the other, and each makes what was fetched stale", async () => {
    const { fake, document } = opened();
    await Promise.all([document.edit("a", toStop(4)), document.edit("b", toStop(8))]);
    expect(fake.made).toEqual([toStop(4), toStop(8)]);
    expect(document.revision.value).toBe(2);
    expect(document.pending.value).toBe(0);
  });

  it("are undone and done again, by their labels", async () => {
    const { fake, document } = opened();
    await document.edit("a", toStop(4));
    expect([document.undoLabel.value, document.redoLabel.value]).toEqual(["A", null]);
    await document.undo();
    expect(fake.done).toEqual([]);
    expect([document.undoLabel.value, document.redoLabel.value]).toEqual([null, "A"]);
    await document.redo();
    expect(fake.done).toEqual([setStop(4)]);
    expect(await document.redo()).toBe(false);
  });

  it("are one request and one step of undo, of however many changes", async () => {
    const { fake, document } = opened();
    await document.edit("both", [setStop(4), { type: "removePoint", name: "a" }]);
    expect(fake.made).toHaveLength(1);
    expect(fake.done).toHaveLength(2);
    // Each takes back one edit, however fast they come.
    await Promise.all([document.edit("c", toStop(8)), document.undo(), document.undo()]);
    expect(fake.done).toEqual([]);
  });

  it("that fail are reported, and everything is read again; nothing is sent to take them back", async () => {
    const { fake, document, failed } = opened();
    fake.failing = "removePoint";
    const read = vi.spyOn(fake, "focusPoints");
    await document.pointsAt(1);
    expect(await document.edit("half", [setStop(4), { type: "removePoint", name: "a" }])).toBe(false);
    await document.pointsAt(1);
    expect(read).toHaveBeenCalledTimes(2);
    expect([fake.made, fake.done]).toEqual([[], []]);
    expect(failed).toHaveLength(1);
    expect([document.undoLabel.value, document.redoLabel.value]).toEqual([null, null]);
  });

  it("points are read once in a revision, and again after an edit", async () => {
    const { fake, document } = opened();
    const read = vi.spyOn(fake, "focusPoints");
    await Promise.all([document.pointsAt(3), document.pointsAt(3), document.pointsAt(4)]);
    expect(read).toHaveBeenCalledTimes(2);
    await document.edit("a", toStop(4));
    await document.pointsAt(3);
    expect(read).toHaveBeenCalledTimes(3);
  });
});

it("who may not edit is told why, and nothing is sent", async () => {
  const fake = new FakeService();
  const failed: unknown[] = [];
  const fail = (error: unknown): void => void failed.push(error);
  const document = new ShotDocument(fake.service, SHOT, "/cam", signal(1), fail, signal("Pip may look, not edit."));
  expect(await document.edit("a", toStop(4))).toBe(false);
  expect([await document.undo(), await document.redo(), fake.made]).toEqual([false, false, []]);
  expect(failed.map((error) => complaintOf(error).message)).toEqual(Array(3).fill("Pip may look, not edit."));
});

describe("the answer to an edit", () => {
  it("is shown without anything being read again, at its own time", async () => {
    const { fake, document } = opened();
    const readout = { ...(await fake.readout()), fStop: 4 };
    const focusSettings = await fake.focusSettings();
    fake.state = { points: [point("a")], readout, focusSettings, photography: null, curve: [] };
    const reads = [
      vi.spyOn(fake, "focusPoints"),
      vi.spyOn(fake, "readout"),
      vi.spyOn(fake, "focusSettings"),
      vi.spyOn(fake, "history"),
    ];
    await document.edit("a", toStop(4));
    const once = reads.map((read) => read.mock.calls.length);
    document.follow(1, false, document.revision.value);
    document.refreshCurve(document.revision.value);
    await turn();
    expect(document.points.value.map(({ name }) => name)).toEqual(["a"]);
    expect([document.readout.value?.fStop, document.fresh.value]).toEqual([4, true]);
    expect(reads.map((read) => read.mock.calls.length)).toEqual(once);
    document.follow(2, false, document.revision.value);
    await turn();
    expect(reads.slice(0, 3).map((read) => read.mock.calls.length)).toEqual([1, 1, 1]);
  });
});

describe("a reading of an earlier revision", () => {
  it("that arrives after the answer to an edit does not replace it", async () => {
    const { fake, document } = opened();
    const saved = await fake.readout();
    let arrive = (): void => undefined;
    vi.spyOn(fake, "readout").mockImplementation(
      () =>
        new Promise((resolve) => {
          arrive = (): void => {
            resolve(saved);
          };
        }),
    );
    document.follow(1, false, 0);
    fake.state = { points: [], readout: { ...saved, fStop: 4 }, focusSettings: null, photography: null, curve: null };
    await document.edit("a", toStop(4));
    document.follow(1, false, document.revision.value);
    arrive();
    await turn();
    expect(document.readout.value?.fStop).toBe(4);
  });
});

describe("two editors of a shot", () => {
  it("see each other's edits when they come back to the page", async () => {
    const { fake, document } = opened();
    await document.catchUp();
    const revision = document.revision.value;
    await document.catchUp();
    expect(document.revision.value).toBe(revision);
    fake.othersDo(setStop(11));
    await document.catchUp();
    expect(document.revision.value).toBe(revision + 1);
    expect(document.undoLabel.value).toBe("What the other did");
  });

  it("undo nothing that they have not seen, and see it then", async () => {
    const { fake, document, failed } = opened();
    await document.edit("a", toStop(4));
    fake.othersDo(setStop(11));
    expect(await document.undo()).toBe(false);
    expect(complaintOf(failed[0]).message).toBe("Somebody else changed this meanwhile.");
    expect(fake.done).toEqual([setStop(4), setStop(11)]);
    expect(document.undoLabel.value).toBe("What the other did");
    await document.undo();
    expect(fake.done).toEqual([setStop(4)]);
    expect(document.undoLabel.value).toBe("A");
  });
});

describe("a drag", () => {
  it("is unsaved as it goes, and is one edit in the end", async () => {
    const { fake, document } = opened();
    const drag = document.drag("stop", toStop);
    for (const stop of [2.8, 4, 5.6]) {
      drag.move(stop);
      expect(document.unsaved.value).toEqual(toStop(stop));
    }
    await turn();
    expect([fake.made, document.revision.value, document.dragging.value]).toEqual([[], 0, true]);
    drag.commit(8);
    expect([document.unsaved.value, document.dragging.value, document.pending.value]).toEqual([toStop(8), false, 1]);
    await turn();
    expect(fake.made).toEqual([toStop(8)]);
    expect([document.unsaved.value, document.revision.value]).toEqual([[], 1]);
    expect(document.undoLabel.value).toBe("Stop");
    await document.undo();
    expect(fake.done).toEqual([]);
    expect(document.undoLabel.value).toBeNull();
  });

  it("shows what the lens does meanwhile, and what the service says of it in the end", async () => {
    const { fake, document } = opened();
    const saved = await fake.readout();
    document.follow(1, false, 0);
    await turn();
    const drag = document.drag("stop", toStop);
    drag.move(4);
    document.showReadout({ ...saved, fStop: 4 }, document.unsaved.value);
    expect(document.readout.value?.fStop).toBe(4);
    drag.commit(4);
    await turn();
    expect(document.readout.value?.fStop).toBe(4); // until it is read again, and not the old one in between
    document.follow(1, false, document.revision.value);
    await turn();
    expect(document.readout.value).toEqual(saved);
  });

  it("that is followed by another one at once leaves that one its say", async () => {
    const { fake, document } = opened();
    let open = (): void => undefined;
    fake.gate = () => new Promise((resolve) => (open = resolve));
    document.drag("stop", toStop).commit(8);
    await turn();
    document.drag("stop", toStop).move(11);
    open();
    await turn();
    expect(fake.made).toEqual([toStop(8)]);
    expect([document.unsaved.value, document.dragging.value]).toEqual([toStop(11), true]);
  });
});

describe("a drag that comes to nothing", () => {
  it("because it is given up was never an edit", async () => {
    const { fake, document } = opened();
    const drag = document.drag("stop", toStop);
    drag.move(4);
    drag.cancel();
    await turn();
    expect(fake.made).toEqual([]);
    expect([document.unsaved.value, document.dragging.value, document.undoLabel.value]).toEqual([[], false, null]);
  });

  it("because it ends where it began is none either", async () => {
    const { fake, document } = opened();
    const drag = document.drag("stop", (stop: number) => (stop === 2 ? [] : toStop(stop)));
    drag.move(4);
    drag.commit(2);
    await turn();
    expect([fake.made, document.unsaved.value, document.dragging.value]).toEqual([[], [], false]);
  });

  it("because it is refused shows again what is saved", async () => {
    const { fake, document, failed } = opened();
    fake.failing = "setCamera";
    const drag = document.drag("stop", toStop);
    drag.move(4);
    drag.commit(8);
    await turn();
    expect(failed).toHaveLength(1);
    expect(fake.made).toEqual([]);
    expect([document.unsaved.value, document.dragging.value]).toEqual([[], false]);
  });
});
