import { signal } from "@preact/signals";
import { KEY_ACTIONS } from "@/editor/key_actions";
import { Session } from "@/editor/session";
import { shaped } from "@/model/key_lanes";
import type { Key } from "@/model/keys";
import { beyondLimits } from "@/model/key_limits";
import { FakeService, SHOT, turn } from "./fake_service";
import { stackAt } from "./keyed_session";
import { point } from "./points";

interface Opened {
  readonly fake: FakeService;
  readonly session: Session;
  readonly failed: unknown[];
}

function keysAt(...times: number[]): Key[] {
  return times.map((time) => ({ time, value: 1, interpolation: "linear" }));
}

/** A session whose camera has keys of its place at frames 1, 10 and 20, and a selected point. */
async function opened(keys = keysAt(1, 10, 20)): Promise<Opened> {
  const fake = new FakeService();
  const failed: unknown[] = [];
  fake.place = { keys, isEdited: true, isInShot: true };
  fake.points = [point("pip", { weight: { 10: 1 } })];
  fake.onMade = (changes) => {
    for (const change of changes)
      if (change.type === "unkeyCamera")
        fake.place = { ...fake.place, keys: fake.place.keys.filter(({ time }) => time !== change.time) };
  };
  const rights = { noEdits: signal(null), noPictures: signal(null) };
  const session = new Session(fake.service, SHOT, "/cam", 1, (error) => failed.push(error), rights);
  await turn();
  return { fake, session, failed };
}

function laneTimes({ keys }: Session): number[] {
  return keys.lanes.value.find(({ label }) => label === "Camera")?.stacks.map(({ time }) => time) ?? [];
}

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

describe("the keys of the camera's place", () => {
  it("are a lane, after all others, and none without them", async () => {
    const { session } = await opened();
    expect(session.keys.lanes.value.map(({ label }) => label)).toEqual(["pip", "Camera"]);
    expect(laneTimes(session)).toEqual([1, 10, 20]);
    expect(session.keys.curves.value.map(({ label }) => label)).toEqual(["pip: Weight"]);
    const without = await opened([]);
    expect(without.session.keys.lanes.value.map(({ label }) => label)).toEqual(["pip"]);
  });

  it("are read again after edits that may move the camera, and after none else of one's own", async () => {
    const { fake, session } = await opened();
    const reads = vi.spyOn(fake.service.fromAbove, "cameraPlace");
    await session.document.edit("weight", [{ type: "alterPoint", name: "pip", values: { weight: 0.5 }, time: 1 }]);
    await turn();
    expect([reads.mock.calls.length, session.cameraPlace.fresh.value]).toEqual([0, true]);
    await session.document.edit("key", [{ type: "unkeyCamera", time: 20 }]);
    await turn();
    expect([reads.mock.calls.length, laneTimes(session)]).toEqual([1, [1, 10]]);
    await session.document.undo();
    await turn();
    expect(reads.mock.calls.length).toBe(2);
  });

  it("are removed like others", async () => {
    const { fake, session, failed } = await opened();
    session.keys.select([stackAt(session, 20)]);
    await session.keys.remove();
    await turn();
    expect(fake.made).toEqual([[{ type: "unkeyCamera", time: 20 }]]);
    expect([laneTimes(session), failed]).toEqual([[1, 10], []]);
  });

  it("are moved all at once, beside those of others", async () => {
    const { fake, session } = await opened();
    const lanes = session.keys.lanes.value;
    session.keys.select(lanes.flatMap(({ stacks }) => stacks.filter(({ time }) => time >= 10)));
    await session.keys.drag(stackAt(session, 20)).commit({ by: 5, reach: null });
    const moves = [
      { time: 10, newTime: 15 },
      { time: 20, newTime: 25 },
    ];
    expect(fake.made).toEqual([
      [
        { type: "unkeyPoint", name: "pip", attribute: "weight", time: 10 },
        expect.objectContaining({ type: "keyPoint", name: "pip" }),
        { type: "moveCameraKeys", moves },
      ],
    ]);
  });
});

describe("keys without a value", () => {
  it("have no shape and no value to copy", async () => {
    const { session } = await opened();
    session.keys.select([stackAt(session, 1)]);
    const [owned] = stackAt(session, 1).keys;
    expect(owned && shaped(owned, "held")).toBe(owned);
    session.keys.copy();
    expect(session.keys.copied.value).toEqual([]);
    const copy = KEY_ACTIONS.find(({ label }) => label === "Copy");
    expect(copy?.refusal(session.keys)).toContain("not copied");
    session.keys.selectLanes();
    session.keys.select(session.keys.lanes.value.flatMap(({ stacks }) => stacks));
    expect(copy?.refusal(session.keys)).toBeNull();
    session.keys.copy();
    expect(session.keys.copied.value).toHaveLength(1);
  });

  it("stay within the times that the service takes", () => {
    expect(beyondLimits([{ type: "moveCameraKeys", moves: [{ time: 1, newTime: 2e9 }] }])).toBe("time");
    expect(beyondLimits([{ type: "unkeyCamera", time: 2e9 }])).toBe("time");
    expect(beyondLimits([{ type: "moveCameraKeys", moves: [{ time: 1, newTime: 2 }] }])).toBeNull();
  });
});

describe("a camera", () => {
  it("loses the key where the playhead is, and only there", async () => {
    const { fake, session } = await opened();
    session.playhead.goTo(11);
    expect(session.cameraMoves.noKeyHere).toContain("no key at this frame");
    await session.cameraMoves.unkey();
    session.playhead.goTo(10);
    expect(session.cameraMoves.noKeyHere).toBeNull();
    await session.cameraMoves.unkey();
    await turn();
    expect(fake.made).toEqual([[{ type: "unkeyCamera", time: 10 }]]);
    expect(session.cameraMoves.noKeyHere).toContain("no key at this frame");
    expect(session.document.unsaved.value).toEqual([]);
  });

  it.each([
    [true, true, null],
    [false, true, "is where the shot has it"],
    [true, false, "is of the edits"],
  ])("edited: %s, in the shot: %s, goes back but for: %s", async (isEdited, isInShot, why) => {
    const { fake, session } = await opened();
    fake.place = { keys: [], isEdited, isInShot };
    session.document.refresh();
    await turn();
    if (why === null) expect(session.cameraMoves.noWayBack).toBeNull();
    else expect(session.cameraMoves.noWayBack).toContain(why);
    await session.cameraMoves.reset();
    expect(fake.made).toEqual([[{ type: "resetCameraPlace" }]]);
  });

  it("frames what a point follows, as a key or not", async () => {
    const { fake, session } = await opened();
    await session.cameraMoves.frame("pip");
    session.cameraMoves.isKeyed.value = true;
    await session.cameraMoves.frame("pip");
    const frame = { type: "frameSubject", point: "pip", time: 1, aspect: 2 };
    expect(fake.made).toEqual([[{ ...frame, keyed: false }], [{ ...frame, keyed: true }]]);
  });
});
