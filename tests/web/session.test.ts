import { signal } from "@preact/signals";
import { MarkerDrag } from "@/editor/marker";
import { Session } from "@/editor/session";
import type { Changes } from "@/model/changes";
import type { Photography } from "@/model/photography";
import type { FocusSettings, Shot } from "@/model/shot";
import { complaintOf } from "@/net/errors";
import { FakeService, SHOT, turn } from "./fake_service";
import { point } from "./points";
import { opened } from "./pointed_session";

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

/** Holds up picks until they are let go, the first one first. */
function heldUp(fake: FakeService): () => Promise<void> {
  const held: (() => void)[] = [];
  fake.pickGate = () => new Promise((resolve) => held.push(resolve));
  return async () => {
    held.shift()?.();
    await turn();
  };
}

function moves(made: readonly Changes[]): unknown[] {
  return made
    .flat()
    .map((change) => (change.type === "movePoint" ? [change.name, change.anchor?.barycentric?.[0]] : change.type));
}

describe("a marker that is dropped", () => {
  it("moves its own point, whichever is selected meanwhile", async () => {
    const { fake, session } = await opened();
    const letGo = heldUp(fake);
    const drag = new MarkerDrag(session, point("near"));
    drag.move([0.2, 0.5]);
    void drag.drop();
    session.selected.value = "far";
    await turn();
    await letGo();
    session.selected.value = null;
    const again = new MarkerDrag(session, point("near"));
    again.move([0.3, 0.5]);
    void again.drop();
    session.selected.value = null;
    await turn();
    await letGo();
    expect(moves(fake.made)).toEqual([
      ["near", 0.2],
      ["near", 0.3],
    ]);
  });

  it("during another pick waits for it, and is shown until it is there", async () => {
    const { fake, session } = await opened();
    const letGo = heldUp(fake);
    const [first, second] = [new MarkerDrag(session, point("near")), new MarkerDrag(session, point("far"))];
    first.move([0.2, 0.5]);
    void first.drop();
    await turn();
    second.move([0.7, 0.5]);
    void second.drop();
    const unsaved = session.document.unsaved.value;
    await letGo();
    expect([session.document.unsaved.value, session.picks.picking.value]).toEqual([unsaved, [0.7, 0.5]]);
    await letGo();
    expect(moves(fake.made)).toEqual([
      ["near", 0.2],
      ["far", 0.7],
    ]);
    expect([session.document.unsaved.value, session.picks.picking.value]).toEqual([[], null]);
  });
});

describe("a marker that is not moved", () => {
  it("as it was dropped on nothing goes back where it was", async () => {
    const { fake, session, failed } = await opened();
    fake.hits = false;
    const drag = new MarkerDrag(session, point("near"));
    drag.move([0.2, 0.5]);
    await drag.drop();
    expect([fake.made, session.document.unsaved.value, failed.length]).toEqual([[], [], 1]);
  });

  it("as its drag was given up leaves alone what another one shows", async () => {
    const { session } = await opened();
    const [first, second] = [new MarkerDrag(session, point("near")), new MarkerDrag(session, point("far"))];
    second.move([0.7, 0.5]);
    first.cancel();
    expect(session.document.dragging.value).toBe(true);
    second.cancel();
    expect([session.document.dragging.value, session.document.unsaved.value]).toEqual([false, []]);
  });
});

describe("a click on the picture", () => {
  it("that moves the selected point moves the one that was selected then", async () => {
    const { fake, session } = await opened();
    const letGo = heldUp(fake);
    void session.picks.click([0.4, 0.5], "move");
    await turn();
    session.selected.value = "near";
    await letGo();
    expect(moves(fake.made)).toEqual([["far", 0.4]]);
  });

  it("during a pick does nothing, and adds a point else", async () => {
    const { fake, session } = await opened();
    const letGo = heldUp(fake);
    void session.picks.click([0.4, 0.5], "add");
    await turn();
    void session.picks.click([0.5, 0.5], "add");
    await letGo();
    await letGo();
    expect(moves(fake.made)).toEqual(["setFocus", "addPoint"]);
    expect(session.selected.value).toBe("thing");
  });
});

describe("a key that is set while it plays", () => {
  it("stops the playhead and has the value at its time", async () => {
    const { fake, session } = await opened();
    vi.stubGlobal("requestAnimationFrame", () => 0);
    session.playhead.play();
    session.playhead.time.value = 7; // the points on the page are still those of frame 1
    fake.points = [point("near", {}, { weight: 0.7 })];
    vi.spyOn(fake, "readout").mockImplementation(async (_?: unknown, time?: number) => ({
      ...(await new FakeService().readout()),
      fStop: time ?? 0,
    }));
    void session.toggleKey(point("near"), "weight");
    void session.toggleSettingKey("f-number", "fStop");
    expect(session.playhead.playing.value).toBe(false);
    await session.idle();
    expect(fake.made.flat()).toMatchObject([
      { type: "keyPoint", name: "near", key: { time: 7, value: 0.7 } },
      { type: "keySetting", setting: "fStop", key: { time: 7, value: 7 } },
    ]);
  });

  it("is of the resource that the setting belongs to, and one that is there is removed", async () => {
    const { fake, session } = await opened();
    const keys = { push: [{ time: 1, value: 0, interpolation: "linear" }] };
    const photography = { exposure: { shutterClose: 0.5, keys: {} }, film: { push: 1, keys } };
    vi.spyOn(fake, "photography").mockResolvedValue(photography as unknown as Photography);
    vi.spyOn(fake, "focusSettings").mockResolvedValue({ tiltDeg: 3, keys: {} } as unknown as FocusSettings);
    for (const setting of ["shutterClose", "push", "tiltDeg"] as const) void session.toggleSettingKey("", setting);
    await session.idle();
    expect(fake.made.flat()).toMatchObject([
      { type: "keySetting", setting: "shutterClose", key: { value: 0.5 } },
      { type: "unkeySetting", setting: "push" },
      { type: "keySetting", setting: "tiltDeg", key: { value: 3 } },
    ]);
  });
});

it("a selected point that is gone, as after an undo, has no name", async () => {
  const { fake, session } = await opened();
  expect(session.selectedName.value).toBe("far");
  fake.points = [point("near")];
  session.document.refresh();
  await turn();
  expect([session.selected.value, session.selectedName.value]).toEqual(["far", null]);
});

describe("a click that can do nothing says why", () => {
  /** What a click on the picture of a shot is answered. */
  async function answers(
    shot: Shot,
    { noEdits = null, hits = true }: { noEdits?: string | null; hits?: boolean },
  ): Promise<(string | null)[][]> {
    const fake = new FakeService();
    fake.hits = hits;
    const failed: unknown[] = [];
    const rights = { noEdits: signal(noEdits), noPictures: signal(null) };
    const session = new Session(fake.service, shot, shot.defaultCamera, 1, (error) => failed.push(error), rights);
    session.box.value = { width: 800, height: 400 };
    await session.picks.click([0.5, 0.5], "pull");
    expect([fake.made, session.picks.picking.value]).toEqual([[], null]);
    return failed.map(complaintOf).map(({ message, advice, remedy }) => [message, advice, remedy]);
  }

  it.each([
    ["where there is no camera", SHOT.cameras.slice(1), "Create one from this view."],
    ["where none of several is looked through", SHOT.cameras, "Choose one above, or create one from this view."],
  ])("%s", async (_, cameras, advice) => {
    const said = await answers({ ...SHOT, cameras, defaultCamera: null }, {});
    expect(said).toEqual([["There is no camera to focus.", advice, null]]);
  });

  it("where the key may not edit", async () => {
    const [said] = await answers(SHOT, { noEdits: "Mara may look at shots, not edit." });
    expect(said).toEqual([
      "Mara may look at shots, not edit.",
      "Whoever gave you the key can give you one that may.",
      null,
    ]);
  });

  it("where nothing is seen", async () => {
    const said = await answers(SHOT, { hits: false });
    expect(said).toEqual([["There is nothing to focus on there.", "Click on a surface.", null]]);
  });
});

describe("a pull", () => {
  it("can be changed until the next edit, as a part of its step of undo", async () => {
    const { fake, session } = await opened();
    session.playhead.goTo(40);
    await turn();
    session.pullTo(point("near"));
    await turn();
    expect(session.pulls.last.value).toMatchObject({ name: "near", time: 40 });
    const times = fake.made.flat().flatMap((change) => (change.type === "keyPoint" ? [change.key.time] : []));
    expect(new Set(times)).toEqual(new Set([28, 40]));
    await session.pulls.change({ frames: 20 });
    expect(fake.gestures[0]).not.toBe("");
    expect(fake.gestures[1]).toBe(fake.gestures[0]);
    expect(session.pulls.choice.frames.value).toBe(20);
    expect(session.pulls.span.value).toEqual({ start: 20, arrival: 40, held: null });
    await session.pointEdits.setKind(point("near"), "soft");
    await turn();
    expect(session.pulls.last.value).toBeNull();
    await session.pulls.change({ reach: "shot" });
    expect(fake.made).toHaveLength(3);
    expect(session.pulls.choice.reach.value).toBe("shot");
  });

  it("that is on its way can be changed again and again", async () => {
    const { fake, session } = await opened();
    session.playhead.goTo(40);
    await turn();
    session.pullTo(point("near"));
    await turn();
    const changes = [session.pulls.change({ reach: "shot" }), session.pulls.change({ frames: 20, reach: "from" })];
    expect(session.pulls.last.value?.pull).toEqual({ reach: "from", frames: 20, ease: "smooth" });
    await Promise.all(changes);
    expect(session.pulls.last.value?.pull).toEqual({ reach: "from", frames: 20, ease: "smooth" });
    expect(new Set(fake.gestures).size).toBe(1);
    expect(fake.made).toHaveLength(3);
  });

  it("is shown while it is aimed at", async () => {
    const { session } = await opened();
    session.playhead.goTo(40);
    expect(session.pulls.span.value).toBeNull();
    session.pulls.aiming.value = true;
    expect(session.pulls.span.value).toEqual({ start: 28, arrival: 40, held: null });
  });
});
