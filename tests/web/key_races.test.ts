/** Gestures on keys that meet each other, an undo, or a service that is slow. */

import { turn } from "./fake_service";
import { nowAt, opened, stackAt } from "./keyed_session";
import { point } from "./points";

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

it("a third drag goes on from the second, when the first is made meanwhile", async () => {
  const { fake, session } = await opened();
  session.keys.select([stackAt(session, 10)]);
  const answers: (() => void)[] = [];
  fake.gate = () =>
    new Promise((resolve) => {
      answers.push(resolve);
    });
  const first = session.keys.drag(stackAt(session, 10)).commit({ by: 4, reach: null });
  const second = session.keys.drag(stackAt(session, 10)).commit({ by: -3, reach: null });
  await turn();
  answers[0]?.();
  await first;
  await turn();
  // As on the page: the key is pressed where it is shown.
  const shown = session.keys.lanes.value
    .flatMap(({ stacks }) => stacks)
    .find((stack) => session.keys.shownAs(stack).time === 11);
  expect(shown).toBeDefined();
  expect(session.keys.selectedStacks.value).toHaveLength(1);
  if (!shown) return;
  session.keys.select([shown]);
  const third = session.keys.drag(shown).commit({ by: 5, reach: null });
  fake.gate = () => Promise.resolve();
  answers[1]?.();
  await Promise.all([second, third]);
  expect(fake.made.map(([removal, key]) => [removal, key])).toMatchObject([
    [{ time: 10 }, { key: { time: 14 } }],
    [{ time: 14 }, { key: { time: 11 } }],
    [{ time: 11 }, { key: { time: 16 } }],
  ]);
});

it("a drag after an undo begins where the key was before", async () => {
  const { fake, session, failed } = await opened();
  session.keys.select([stackAt(session, 10)]);
  const moved = session.keys.drag(stackAt(session, 10)).commit({ by: -6, reach: null });
  const undone = session.document.undo();
  expect(session.keys.shownAs(stackAt(session, 10)).time).toBe(10);
  session.keys.select([stackAt(session, 10)]);
  const again = session.keys.drag(stackAt(session, 10)).commit({ by: 3, reach: null });
  await Promise.all([moved, undone, again]);
  expect(fake.made.at(-1)).toMatchObject([{ time: 10 }, { key: { time: 13 } }]);
  expect(failed).toEqual([]);
});

it("while a key is dragged, nothing is undone, removed or pasted", async () => {
  const { fake, session } = await opened();
  session.keys.select([stackAt(session, 20)]);
  session.keys.copy();
  await session.keys.drag(stackAt(session, 20)).commit({ by: 1, reach: null });
  nowAt(fake, 1, 10, 21);
  session.document.refresh();
  await turn();
  const drag = session.keys.drag(stackAt(session, 10));
  drag.move({ by: 2, reach: null });
  expect(await session.document.undo()).toBe(false);
  await session.keys.remove();
  await session.keys.paste();
  expect(fake.made).toHaveLength(1);
  drag.cancel();
  await session.keys.remove();
  expect(fake.made).toHaveLength(2);
});

it("several keys stay in the shot together", async () => {
  const { fake, session } = await opened();
  session.keys.select(session.keys.lanes.value.flatMap(({ stacks }) => stacks));
  await session.keys.drag(stackAt(session, 10)).commit({ by: 90, reach: null });
  expect(fake.made[0]?.slice(3)).toMatchObject([{ key: { time: 77 } }, { key: { time: 86 } }, { key: { time: 96 } }]);
});

it("a drag of a key that an edit under way has removed sets it where it goes", async () => {
  const { fake, session, failed } = await opened();
  session.keys.select([stackAt(session, 10)]);
  const other = session.document.edit("other", [{ type: "setFocus", values: { lagS: 1 } }]);
  const drag = session.keys.drag(stackAt(session, 10)).commit({ by: 4, reach: null });
  nowAt(fake, 1, 20);
  await Promise.all([other, drag]);
  expect(fake.made[1]).toMatchObject([{ type: "keyPoint", key: { time: 14 } }]);
  expect(failed).toEqual([]);
});

it("keys that are removed twice are removed once, without a complaint", async () => {
  const { fake, session, failed } = await opened();
  session.keys.select([stackAt(session, 10)]);
  const first = session.keys.remove();
  nowAt(fake, 1, 20);
  await Promise.all([first, session.keys.remove()]);
  expect(fake.made).toHaveLength(1);
  expect(failed).toEqual([]);
});

it("copied keys of a point that is gone are not pasted, and that is said", async () => {
  const { fake, session, failed } = await opened();
  session.keys.select([stackAt(session, 10)]);
  session.keys.copy();
  fake.points = [point("mara")];
  fake.state = { points: fake.points, readout: null, focusSettings: null, photography: null, curve: null };
  await session.document.edit("Remove pip", [{ type: "removePoint", name: "pip" }]);
  await turn();
  await session.keys.paste();
  expect(fake.made).toHaveLength(1);
  expect(failed).toMatchObject([{ message: "The points of the copied keys are gone." }]);
});

it("copied keys follow their point to its new name", async () => {
  const { fake, session, failed } = await opened();
  session.keys.select([stackAt(session, 10)]);
  session.keys.copy();
  fake.onMade = () => {
    fake.points = [point("robot", { weight: { 1: 1, 10: 0, 20: 1 } })];
  };
  await session.pointEdits.rename(point("pip"), "robot");
  await turn();
  session.playhead.goTo(40);
  await turn();
  await session.keys.paste();
  expect(fake.made[1]).toMatchObject([{ type: "keyPoint", name: "robot", key: { time: 40 } }]);
  expect(failed).toEqual([]);
});

describe("a point that edits under way", () => {
  it("rename keeps the keys that are dragged meanwhile", async () => {
    const { fake, session, failed } = await opened();
    session.keys.select([stackAt(session, 10)]);
    const renamed = session.pointEdits.rename(point("pip"), "robot");
    const moved = session.keys.drag(stackAt(session, 10)).commit({ by: 4, reach: null });
    fake.onMade = () => {
      fake.points = [point("robot", { weight: { 1: 1, 10: 0, 20: 1 } })];
    };
    await Promise.all([renamed, moved]);
    expect(fake.made[1]).toMatchObject([
      { type: "unkeyPoint", name: "robot", time: 10 },
      { type: "keyPoint", name: "robot", key: { time: 14 } },
    ]);
    expect(failed).toEqual([]);
  });

  it("remove has no keys to be dragged, and that is said", async () => {
    const { fake, session, failed } = await opened();
    session.keys.select([stackAt(session, 10)]);
    const removed = session.pointEdits.remove(point("pip"));
    const moved = session.keys.drag(stackAt(session, 10)).commit({ by: 4, reach: null });
    fake.onMade = () => {
      fake.points = [];
    };
    await Promise.all([removed, moved]);
    expect(fake.made).toHaveLength(1);
    expect(failed).toMatchObject([{ message: "There is no pip any more." }]);
  });
});
