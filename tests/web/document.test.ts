import { signal } from "@preact/signals";
import { ShotDocument } from "@/editor/document";
import type { Change, Command } from "@/model/command";
import { FakeService, SHOT, turn } from "./fake_service";

function setStop(fStop: number): Command {
  return { do: "setLens", change: { fStop }, time: null };
}

/** From f/2, which undo goes back to. */
function toStop(fStop: number): Change {
  return { redo: [setStop(fStop)], undo: [setStop(2)] };
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

  it("are undone and done again", async () => {
    const { fake, document } = opened();
    await document.edit("a", toStop(4));
    await document.undo();
    await document.redo();
    expect(fake.performed).toEqual([setStop(4), setStop(2), setStop(4)]);
    await document.redo();
    expect(fake.performed).toHaveLength(3);
  });

  it("of which a part fails are taken back whole, told, and not in the history", async () => {
    const { fake, document, failed } = opened();
    fake.failing = "setKey";
    const key = { time: 1, value: 1, interpolation: "linear" } as const;
    const half: Change = {
      redo: [setStop(4), { do: "setKey", name: "a", attribute: "weight", key }],
      undo: [setStop(2)],
    };
    expect(await document.edit("half", half)).toBe(false);
    expect(fake.performed).toEqual([setStop(4), setStop(2)]);
    expect(failed).toHaveLength(1);
    expect(document.history.value.edits).toEqual([]);
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

describe("edits of more than can be told", () => {
  it("are undone by going back to what was before them", async () => {
    const { fake, document } = opened();
    const mount: Command = { do: "mountLens", lens: "planar_50" };
    // What is on its way already belongs to what was before.
    await Promise.all([document.edit("a", toStop(4)), document.editWhole("mount", mount)]);
    await document.undo();
    await document.redo();
    expect(fake.performed).toEqual([setStop(4), mount, { do: "restoreEdits", revision: "1" }, mount]);
  });

  it("are not in the history where the service refuses them", async () => {
    const { fake, document, failed } = opened();
    fake.failing = "mountLens";
    expect(await document.editWhole("mount", { do: "mountLens", lens: "planar_50" })).toBe(false);
    expect(failed).toHaveLength(1);
    expect(document.history.value.edits).toEqual([]);
  });
});

describe("a drag", () => {
  it("is one edit, from where it began to where it ended", async () => {
    const { fake, document } = opened();
    const drag = document.drag("stop", 2, toStop);
    for (const stop of [2.8, 4, 5.6]) {
      drag.move(stop);
      await turn();
    }
    drag.commit(8);
    await turn();
    expect(fake.performed.at(-1)).toEqual(setStop(8));
    expect(document.history.value.edits).toMatchObject([{ label: "stop", undo: [setStop(2)] }]);
    expect(document.dragging.value).toBe(false);
  });

  it("skips the values that a slow service has no time for", async () => {
    const { fake, document } = opened();
    let open = (): void => undefined;
    fake.gate = () => new Promise((resolve) => (open = resolve));
    const drag = document.drag("stop", 2, toStop);
    for (const stop of [2.8, 4, 5.6]) drag.move(stop);
    drag.commit(8);
    await turn();
    open();
    await turn();
    open();
    await turn();
    expect(fake.performed).toEqual([setStop(2.8), setStop(8)]);
  });

  it("that is given up leaves all as it was, and no edit", async () => {
    const { fake, document } = opened();
    const drag = document.drag("stop", 2, toStop);
    drag.move(4);
    await turn();
    drag.cancel();
    await turn();
    expect(fake.performed.at(-1)).toEqual(setStop(2));
    expect(document.history.value.edits).toEqual([]);
    expect(document.dragging.value).toBe(false);
  });
});
