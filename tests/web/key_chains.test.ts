/** Edits of keys, each of which is begun while the one before it is under way. */

import type { Session } from "@/editor/session";
import { opened, stackAt } from "./keyed_session";
import { point } from "./points";

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

function move(session: Session, time: number, by: number): Promise<number | null> {
  return session.keys.drag(stackAt(session, time)).commit({ by, reach: null });
}

it("keys of several points leave out a point that is removed in between", async () => {
  const { fake, session, failed } = await opened();
  fake.points = [...fake.points, point("mara", { weight: { 10: 1 } })];
  session.document.refresh();
  await vi.waitUntil(() => session.keys.lanes.value.length === 2);
  const both = session.keys.lanes.value.flatMap(({ stacks }) => stacks.filter(({ time }) => time === 10));
  session.keys.select(both);
  const moved = move(session, 10, 4);
  const { onMade } = fake;
  fake.onMade = (changes) => {
    onMade(changes);
    if (changes[0]?.type === "removePoint") fake.points = fake.points.filter(({ name }) => name !== "mara");
  };
  const removed = session.pointEdits.remove(point("mara"));
  session.keys.shape("held");
  await Promise.all([moved, removed]);
  await session.idle();
  expect(both).toHaveLength(2);
  expect(fake.made.at(-1)).toMatchObject([{ type: "keyPoint", name: "pip", key: { time: 14, interpolation: "held" } }]);
  expect(failed).toEqual([]);
});

it("a key that is moved, removed and moved again stays removed", async () => {
  const { fake, session, failed } = await opened();
  session.keys.select([stackAt(session, 10)]);
  const moved = move(session, 10, 4);
  const removed = session.keys.remove();
  session.keys.copy();
  session.keys.select([stackAt(session, 10)]);
  await Promise.all([moved, removed, move(session, 10, -2)]);
  expect(fake.made).toMatchObject([[{ time: 10 }, { key: { time: 14 } }], [{ type: "unkeyPoint", time: 14 }]]);
  expect(fake.points[0]?.keys.weight?.map(({ time }) => time)).toEqual([1, 20]);
  expect(session.keys.copied.value).toEqual([]);
  expect(failed).toEqual([]);
});

it("a key whose move fails is not moved on from where it would have been, nor removed there", async () => {
  const { fake, session, failed } = await opened();
  session.keys.select([stackAt(session, 10)]);
  fake.failing = "unkeyPoint";
  const first = move(session, 10, 4);
  const second = move(session, 10, 4);
  const removed = session.keys.remove();
  await first;
  fake.failing = null;
  await Promise.all([second, removed]);
  expect(fake.made).toEqual([]);
  expect(failed).toHaveLength(1);
  expect(session.keys.selectedStacks.value.map(({ time }) => time)).toEqual([10]);
});

it("a removal that fails leaves the keys selected, and they can be moved", async () => {
  const { fake, session, failed } = await opened();
  session.keys.select([stackAt(session, 10)]);
  fake.failing = "unkeyPoint";
  await session.keys.remove();
  fake.failing = null;
  expect(failed).toHaveLength(1);
  expect(session.keys.selectedStacks.value.map(({ time }) => time)).toEqual([10]);
  await move(session, 10, 2);
  expect(fake.made).toMatchObject([[{ time: 10 }, { key: { time: 12 } }]]);
});

it("a removal before the points of a new revision are there is of the keys as they are", async () => {
  const { fake, session, failed } = await opened();
  session.keys.select([stackAt(session, 10)]);
  let answer = (): void => undefined;
  const late = new Promise<void>((resolve) => (answer = resolve));
  vi.spyOn(fake, "focusPoints").mockImplementation(async () => {
    await late;
    return [point("pip", { weight: { 1: 1, 20: 1 } })];
  });
  session.document.refresh();
  await vi.waitUntil(() => session.document.fresh.value);
  const removed = session.keys.remove();
  answer();
  await removed;
  expect(fake.made).toEqual([]);
  expect(failed).toEqual([]);
});
