import { signal } from "@preact/signals";
import { Session } from "@/editor/session";
import type { Keyed } from "@/model/keys";
import { FakeService, SHOT, turn } from "./fake_service";
import { nowAt, opened, stackAt } from "./keyed_session";
import { point } from "./points";

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

describe("a drag of keys", () => {
  it("is seen in the picture, and is one edit", async () => {
    const { fake, session } = await opened();
    const stack = stackAt(session, 10);
    session.keys.select([stack]);
    const drag = session.keys.drag(stack);
    drag.move({ by: 1.9, reach: 0.1 });
    drag.move({ by: 4.2, reach: 0.1 });
    expect(session.keys.shownAs(stack).time).toBe(14);
    expect(session.document.unsaved.value.map(({ type }) => type)).toEqual(["unkeyPoint", "keyPoint"]);
    nowAt(fake, 1, 14, 20);
    expect(await drag.commit({ by: 4.2, reach: 0.1 })).toBe(14);
    expect(fake.made).toHaveLength(1);
    await turn();
    expect(session.keys.selectedStacks.value.map(({ time }) => time)).toEqual([14]);
    expect(session.document.unsaved.value).toEqual([]);
  });

  it("moves all that are selected, and snaps to the playhead and other keys but not to itself", async () => {
    const { fake, session } = await opened();
    session.playhead.time.value = 12.25;
    session.keys.select([stackAt(session, 10), stackAt(session, 20)]);
    const drag = session.keys.drag(stackAt(session, 10));
    drag.move({ by: 2.3, reach: 0.2 });
    expect(session.keys.shownAs(stackAt(session, 10)).time).toBe(12.25);
    drag.move({ by: 9.6, reach: 0.2 });
    expect(session.keys.shownAs(stackAt(session, 10)).time).toBe(20);
    await drag.commit({ by: -9.1, reach: 0.2 });
    expect(fake.made[0]?.slice(2)).toMatchObject([{ key: { time: 1 } }, { key: { time: 11 } }]);
  });

  it("that is given up leaves everything as it was", async () => {
    const { fake, session } = await opened();
    const stack = stackAt(session, 10);
    session.keys.select([stack]);
    const drag = session.keys.drag(stack);
    drag.move({ by: 5, reach: null });
    drag.cancel();
    expect([session.keys.shownAs(stack).time, session.document.unsaved.value, fake.made]).toEqual([10, [], []]);
    expect(session.document.dragging.value).toBe(false);
  });
});

describe("a drag of keys whose service is slow", () => {
  it("goes on from where the one before it goes, though that is not there yet", async () => {
    const { fake, session } = await opened();
    const stack = stackAt(session, 10);
    session.keys.select([stack]);
    const first = session.keys.drag(stack).commit({ by: 1, reach: null });
    const second = session.keys.drag(stack);
    second.move({ by: 1, reach: null });
    expect(session.keys.shownAs(stack).time).toBe(12);
    nowAt(fake, 1, 12, 20);
    await Promise.all([first, second.commit({ by: 1, reach: null })]);
    expect(fake.made.map((changes) => changes.map((change) => ("time" in change ? change.time : 0)))).toEqual([
      [10, 0],
      [11, 0],
    ]);
    await turn();
    expect(session.keys.selectedStacks.value.map(({ time }) => time)).toEqual([12]);
    expect(session.keys.shownAs(stackAt(session, 12)).time).toBe(12);
  });

  it("goes on where it is when the one before it is made", async () => {
    const { fake, session } = await opened();
    session.keys.select([stackAt(session, 10)]);
    const first = session.keys.drag(stackAt(session, 10)).commit({ by: 1, reach: null });
    const second = session.keys.drag(stackAt(session, 10));
    second.move({ by: 1, reach: null });
    nowAt(fake, 1, 11, 20);
    await first;
    await turn();
    second.move({ by: 3, reach: null });
    expect(session.keys.shownAs(stackAt(session, 11)).time).toBe(14);
    expect(await second.commit({ by: 3, reach: null })).toBe(14);
    expect(fake.made.at(-1)).toMatchObject([{ time: 11 }, { key: { time: 14 } }]);
  });
});

describe("while keys are moved", () => {
  it("others that are selected then stay", async () => {
    const { fake, session } = await opened();
    session.keys.select([stackAt(session, 10)]);
    const first = session.keys.drag(stackAt(session, 10)).commit({ by: 1, reach: null });
    session.keys.select([stackAt(session, 20)]);
    expect(session.keys.shownAs(stackAt(session, 20)).time).toBe(20);
    session.keys.drag(stackAt(session, 20)).move({ by: 3, reach: null });
    expect(session.document.unsaved.value[0]).toMatchObject({ type: "unkeyPoint", time: 20 });
    nowAt(fake, 1, 11, 20);
    await first;
    await turn();
    expect(session.keys.selectedStacks.value.map(({ time }) => time)).toEqual([20]);
  });

  it("a refusal of the service puts them back", async () => {
    const { fake, session, failed } = await opened();
    fake.failing = "keyPoint";
    const stack = stackAt(session, 10);
    session.keys.select([stack]);
    expect(await session.keys.drag(stack).commit({ by: 3, reach: null })).toBe(null);
    await turn();
    expect([session.keys.shownAs(stackAt(session, 10)).time, failed.length]).toEqual([10, 1]);
  });
});

describe("edits of selected keys", () => {
  it("go on from each other, though none is there yet", async () => {
    const { fake, session } = await opened();
    const stack = stackAt(session, 10);
    session.keys.select([stack]);
    session.keys.setValue(0.5);
    session.keys.shape("held");
    const key = { time: 12, value: 0.5, interpolation: "held" };
    await session.keys.drag(stack).commit({ by: 2, reach: null });
    expect(fake.made.at(-1)?.[1]).toMatchObject({ type: "keyPoint", key });
  });

  it("move a distance of infinity as one far away, before it is there", async () => {
    const { fake, session } = await opened();
    const stack = stackAt(session, 10);
    session.keys.select([stack]);
    session.keys.setValue(Infinity);
    await session.keys.drag(stack).commit({ by: 2, reach: null });
    expect(fake.made.at(-1)?.[1]).toMatchObject({ key: { time: 12, value: 100_000 } });
  });

  it("that are refused leave the keys selected", async () => {
    const { fake, session } = await opened();
    fake.failing = "unkeyPoint";
    session.keys.select([stackAt(session, 10)]);
    await session.keys.remove();
    expect(session.keys.selectedStacks.value.map(({ time }) => time)).toEqual([10]);
    fake.failing = null;
    await session.keys.remove();
    expect(session.keys.selectedStacks.value).toEqual([]);
  });

  it("keep the keys in the shot", async () => {
    const { fake, session } = await opened();
    session.keys.select([stackAt(session, 10)]);
    await session.keys.drag(stackAt(session, 10)).commit({ by: -50, reach: null });
    session.keys.select([stackAt(session, 20)]);
    session.keys.moveTo(1000);
    await session.document.idle();
    expect(fake.made.map((changes) => changes[1])).toMatchObject([{ key: { time: 1 } }, { key: { time: 96 } }]);
  });

  it("stop the playing, and are of the keys that were selected last", async () => {
    const { session } = await opened();
    session.playhead.playing.value = true;
    session.keys.select([stackAt(session, 10)]);
    session.keys.drag(stackAt(session, 10)).move({ by: 1, reach: null });
    expect(session.playhead.playing.value).toBe(false);
    session.selected.value = "pip";
    expect(session.keys.selectedStacks.value).toEqual([]);
  });
});

it("who may not edit sees the keys where they were", async () => {
  const fake = new FakeService();
  fake.points = [point("pip", { weight: { 1: 1, 10: 0 } })];
  const failed: unknown[] = [];
  const rights = { noEdits: signal("You may not."), noPictures: signal(null) };
  const session = new Session(fake.service, SHOT, "/cam", 1, (error) => failed.push(error), rights);
  await turn();
  const stack = stackAt(session, 10);
  session.keys.select([stack]);
  await session.keys.drag(stack).commit({ by: 3, reach: null });
  expect([session.keys.shownAs(stack).time, session.document.unsaved.value, failed.length]).toEqual([10, [], 1]);
});

it("more keys than an edit takes are refused with what to do", async () => {
  const { fake, session, failed } = await opened();
  fake.points = [point("pip", { weight: Object.fromEntries(Array.from({ length: 513 }, (_, i) => [1 + i / 8, 1])) })];
  session.document.refresh();
  await turn();
  session.keys.select(session.keys.lanes.value.flatMap(({ stacks }) => stacks));
  session.keys.moveTo(2);
  await turn();
  expect([fake.made, failed.length, session.keys.shownAs(stackAt(session, 1)).time]).toEqual([[], 1, 1]);
});

it("stacks are added to the selection and taken out of it, and those of their lanes are all selected", async () => {
  const { session } = await opened();
  const { keys } = session;
  const [one, ten] = [stackAt(session, 1), stackAt(session, 10)];
  keys.select([one]);
  keys.select([ten], true);
  expect(keys.selectedStacks.value).toEqual([one, ten]);
  keys.select([one], true);
  expect(keys.selectedStacks.value).toEqual([ten]);
  keys.selectLanes();
  expect(keys.selectedStacks.value.map(({ time }) => time)).toEqual([1, 10, 20]);
  expect([keys.clear(), keys.clear()]).toEqual([true, false]);
});

it("keys that are simplified are edited in one change, and those that are left are selected", async () => {
  const { fake, session } = await opened();
  const keyed = (...times: number[]): Keyed => ({
    focusDistanceM: times.map((time) => ({ time, value: 3, interpolation: "linear" })),
  });
  fake.keyed = keyed(1, 2, 3, 4);
  session.document.refresh();
  await turn();
  const lane = session.keys.lanes.value.find(({ id }) => id === "camera focusDistanceM");
  session.keys.select(lane?.stacks ?? []);
  session.keys.tolerance.value = 0.05;
  fake.simplified = [{ setting: "focusDistanceM", before: 4, after: 2, off: 0.01 }];
  fake.keyed = keyed(1, 4);
  await session.keys.simplify("focusDistanceM");
  await turn();
  expect(fake.made).toEqual([[{ type: "simplifySetting", setting: "focusDistanceM", tolerance: 0.05 }]]);
  expect(session.document.simplified.value?.after).toBe(2);
  expect(session.keys.selectedStacks.value.map(({ time }) => time)).toEqual([1, 4]);
  await session.document.undo();
  expect(session.document.simplified.value).toBeNull();
});

it("keys that were dragged and put back follow the service again", async () => {
  const { fake, session } = await opened();
  const stack = stackAt(session, 10);
  session.keys.select([stack]);
  const drag = session.keys.drag(stack);
  drag.move({ by: 3, reach: null });
  drag.cancel();
  fake.points = [point("pip", { weight: { 1: 1, 10: 0.33, 20: 1 } })];
  session.document.refresh();
  await turn();
  expect(session.keys.shownAs(stackAt(session, 10)).keys[0]?.key.value).toBe(0.33);
});

it("keys that are selected again while they are moved go on from where they go", async () => {
  const { fake, session } = await opened();
  const stack = stackAt(session, 10);
  session.keys.select([stack]);
  const first = session.keys.drag(stack).commit({ by: 2, reach: null });
  session.keys.select([stack]);
  expect(session.keys.shownAs(stack).time).toBe(12);
  await Promise.all([first, session.keys.drag(stack).commit({ by: 2, reach: null })]);
  expect(fake.made[1]).toMatchObject([{ time: 12 }, { key: { time: 14 } }]);
});

it("a key that is added is selected once it is there", async () => {
  const { fake, session } = await opened();
  nowAt(fake, 1, 10, 15, 20);
  const keys = stackAt(session, 10)
    .keys.concat(stackAt(session, 20).keys)
    .map(({ key }) => key);
  await session.keys.add({ point: "pip", attribute: "weight" }, keys, 15);
  await turn();
  expect(fake.made[0]).toMatchObject([{ type: "keyPoint", name: "pip", key: { time: 15, value: 0.5 } }]);
  expect(session.keys.selectedStacks.value.map(({ time }) => time)).toEqual([15]);
});

describe("copied keys", () => {
  it("are set from the playhead on, and selected", async () => {
    const { fake, session } = await opened();
    await session.keys.paste(); // nothing
    session.keys.select([stackAt(session, 10), stackAt(session, 20)]);
    session.keys.copy();
    session.playhead.goTo(40);
    nowAt(fake, 1, 10, 20, 40, 50);
    await session.keys.paste();
    await turn();
    expect(fake.made[0]).toMatchObject([{ key: { time: 40, value: 0 } }, { key: { time: 50, value: 1 } }]);
    expect(session.keys.selectedStacks.value.map(({ time }) => time)).toEqual([40, 50]);
  });
});

it("keys are stretched to a length and turned round, each in one edit", async () => {
  const { fake, session } = await opened();
  session.keys.select(session.keys.lanes.value.flatMap(({ stacks }) => stacks));
  session.keys.stretchTo(38);
  nowAt(fake, 1, 19, 39);
  await session.document.idle();
  await turn();
  expect(fake.made[0]?.slice(2)).toMatchObject([{ key: { time: 19 } }, { key: { time: 39 } }]);
  session.keys.mirror();
  await session.document.idle();
  expect(fake.made).toHaveLength(2);
});

it("keys are stretched to a playhead after the first of them, and their values are spread", async () => {
  const { fake, session } = await opened();
  session.keys.select([stackAt(session, 10), stackAt(session, 20)]);
  expect(session.keys.noStretch).toContain("not after");
  session.playhead.goTo(30);
  expect(session.keys.noStretch).toBeNull();
  session.keys.stretchToPlayhead();
  await session.document.idle();
  expect(fake.made[0]?.slice(1)).toMatchObject([{ key: { time: 30 } }]);
  nowAt(fake, 1, 10, 20);
  await session.document.edit("other", [{ type: "setFocus", values: { lagS: 1 } }]);
  await turn();
  fake.made.length = 0;
  session.keys.select([stackAt(session, 1), stackAt(session, 10)]);
  session.keys.respan(0.25, 0.5);
  await session.document.idle();
  expect(fake.made[0]).toMatchObject([{ key: { value: 0.5 } }, { key: { value: 0.5 } }]);
});
