import { signal } from "@preact/signals";
import { ShotDocument } from "@/editor/document";
import type { Change, Command } from "@/model/command";
import { complaintOf } from "@/net/errors";
import { FakeService, SHOT, turn } from "./fake_service";

function setStop(fStop: number): Command {
  return { do: "setLens", change: { fStop }, time: null };
}

function toStop(fStop: number): Change {
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
    expect(fake.performed).toEqual([setStop(4), setStop(8)]);
    expect(document.revision.value).toBe(2);
    expect(document.pending.value).toBe(0);
  });

  it("are undone and done again, by the name that the person knows them by", async () => {
    const { fake, document } = opened();
    await document.edit("a", toStop(4));
    expect([document.undoLabel.value, document.redoLabel.value]).toEqual(["a", null]);
    await document.undo();
    expect(fake.done).toEqual([]);
    expect([document.undoLabel.value, document.redoLabel.value]).toEqual([null, "a"]);
    await document.redo();
    expect(fake.done).toEqual([setStop(4)]);
    expect(await document.redo()).toBe(false);
  });

  it("are one step of undo, of however many commands", async () => {
    const { fake, document } = opened();
    await document.edit("both", [setStop(4), { do: "removePoint", name: "a" }]);
    expect(fake.done).toHaveLength(2);
    // Each takes back one edit, however fast they come.
    await Promise.all([document.edit("c", toStop(8)), document.undo(), document.undo()]);
    expect(fake.done).toEqual([]);
  });

  it("of which a part fails are taken back whole, told, and not in the history", async () => {
    const { fake, document, failed } = opened();
    fake.failing = "removePoint";
    expect(await document.edit("half", [setStop(4), { do: "removePoint", name: "a" }])).toBe(false);
    expect(fake.performed).toEqual([setStop(4)]);
    expect(fake.done).toEqual([]);
    expect(failed).toHaveLength(1);
    expect([document.undoLabel.value, document.redoLabel.value]).toEqual([null, null]);
  });

  it("points are asked for once in a revision, and anew after an edit", async () => {
    const { fake, document } = opened();
    const asked = vi.spyOn(fake, "focusPoints");
    await Promise.all([document.pointsAt(3), document.pointsAt(3), document.pointsAt(4)]);
    expect(asked).toHaveBeenCalledTimes(2);
    await document.edit("a", toStop(4));
    await document.pointsAt(3);
    expect(asked).toHaveBeenCalledTimes(3);
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
    expect(document.undoLabel.value).toBe("What the service calls it");
  });

  it("undo nothing that they have not seen, and see it then", async () => {
    const { fake, document, failed } = opened();
    await document.edit("a", toStop(4));
    fake.othersDo(setStop(11));
    expect(await document.undo()).toBe(false);
    expect(complaintOf(failed[0]).message).toBe("Somebody else changed this meanwhile.");
    expect(fake.done).toEqual([setStop(4), setStop(11)]);
    expect(document.undoLabel.value).toBe("What the service calls it");
    await document.undo();
    expect(fake.done).toEqual([setStop(4)]);
    expect(document.undoLabel.value).toBe("a");
  });

  it("keep what the other did when an edit is taken back", async () => {
    const { fake, document } = opened();
    await document.edit("a", toStop(4));
    fake.othersDo(setStop(11));
    fake.failing = "removePoint";
    await document.edit("half", [setStop(8), { do: "removePoint", name: "a" }]);
    expect(fake.done).toEqual([setStop(4), setStop(11)]);
  });
});

describe("a drag", () => {
  it("is one edit, from where it began to where it ended", async () => {
    const { fake, document } = opened();
    const drag = document.drag("stop", toStop);
    for (const stop of [2.8, 4, 5.6]) {
      drag.move(stop);
      await turn();
    }
    drag.commit(8);
    await turn();
    expect(fake.performed.at(-1)).toEqual(setStop(8));
    expect(document.undoLabel.value).toBe("stop");
    await document.undo();
    expect(fake.done).toEqual([]);
    expect(document.undoLabel.value).toBeNull();
    expect(document.dragging.value).toBe(false);
  });

  it("skips the values that a slow service has no time for", async () => {
    const { fake, document } = opened();
    let open = (): void => undefined;
    fake.gate = () => new Promise((resolve) => (open = resolve));
    const drag = document.drag("stop", toStop);
    for (const stop of [2.8, 4, 5.6]) drag.move(stop);
    drag.commit(8);
    await turn();
    open();
    await turn();
    open();
    await turn();
    expect(fake.performed).toEqual([setStop(2.8), setStop(8)]);
  });
});

describe("a drag that comes to nothing", () => {
  it("because it is given up leaves all as it was, and no edit", async () => {
    const { fake, document } = opened();
    const drag = document.drag("stop", toStop);
    drag.move(4);
    await turn();
    drag.cancel();
    await turn();
    expect(fake.performed).toEqual([setStop(4)]);
    expect(fake.done).toEqual([]);
    expect([document.undoLabel.value, document.redoLabel.value]).toEqual([null, null]);
    expect(document.dragging.value).toBe(false);
  });

  it("because it is refused ends there", async () => {
    const { fake, document, failed } = opened();
    fake.failing = "setLens";
    const drag = document.drag("stop", toStop);
    drag.move(4);
    await turn();
    fake.failing = null;
    drag.move(5);
    drag.commit(8);
    await turn();
    expect(failed).toHaveLength(1);
    expect(fake.performed).toEqual([]);
    expect(document.dragging.value).toBe(false);
  });
});
