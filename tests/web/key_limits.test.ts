/** Keys beyond what the service takes, which the page does not send. */

import type { Session } from "@/editor/session";
import { beyondLimits } from "@/model/key_limits";
import type { Key } from "@/model/keys";
import { opened, stackAt } from "./keyed_session";

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

const KEY: Key = { time: 1, value: 1, interpolation: "linear" };

function selectAll({ keys }: Session): void {
  keys.select(keys.lanes.value.flatMap(({ stacks }) => stacks));
}

it.each<[string | null, Partial<Key>]>([
  [null, { time: -1e9, value: 1e9, tangents: { inSlope: 0, inWidth: 0, outSlope: -1e9, outWidth: 1e6 } }],
  ["time", { time: 1.1e9 }],
  ["time", { time: -1.1e9 }],
  ["value", { value: 2e9 }],
  ["value", { value: NaN }],
  ["handle", { interpolation: "bezier", tangents: { inSlope: 0, inWidth: 2e6, outSlope: 0, outWidth: 0 } }],
  ["handle", { interpolation: "bezier", tangents: { inSlope: 0, inWidth: 1, outSlope: 2e9, outWidth: 1 } }],
])("the service takes all but %s of %o", (beyond, of) => {
  const key = { ...KEY, ...of };
  expect(beyondLimits([{ type: "keySetting", setting: "fStop", key }])).toBe(beyond);
  expect(beyondLimits([{ type: "keyPoint", name: "pip", attribute: "weight", key }])).toBe(beyond);
});

it("a removal has a time alone, and other changes no keys", () => {
  expect(beyondLimits([{ type: "unkeySetting", setting: "fStop", time: 2e9 }])).toBe("time");
  expect(beyondLimits([{ type: "removePoint", name: "pip" }])).toBeNull();
});

it("keys are not stretched beyond, and that is said", async () => {
  const { fake, session, failed } = await opened();
  selectAll(session);
  session.keys.stretchTo(1e9);
  await session.idle();
  expect(fake.made).toEqual([]);
  expect(failed).toMatchObject([
    { message: "The keys would be too far away.", advice: "Frames go from −1,000,000,000 to 1,000,000,000." },
  ]);
  expect(session.document.unsaved.value).toEqual([]);
  expect(session.keys.selectedStacks.value.map((stack) => session.keys.shownAs(stack).time)).toEqual([1, 10, 20]);
  session.keys.stretchTo(1e9 - 1);
  await session.idle();
  expect(fake.made[0]?.at(-1)).toMatchObject({ key: { time: 1e9 } });
});

it("keys far away that were pasted would go beyond, and that is said", async () => {
  const { fake, session, failed } = await opened();
  selectAll(session);
  session.keys.stretchTo(1e9 - 1);
  await session.idle();
  await vi.waitUntil(() => session.keys.lanes.value[0]?.stacks.at(-1)?.time === 1e9);
  selectAll(session);
  session.keys.copy();
  session.playhead.goTo(50);
  await session.keys.paste();
  expect(fake.made).toHaveLength(1);
  expect(failed).toMatchObject([{ message: "The keys would be too far away." }]);
});

it("a drag that would go beyond is not shown in the picture, nor made", async () => {
  const { fake, session, failed } = await opened();
  session.keys.select([stackAt(session, 10)]);
  const drag = session.keys.drag(stackAt(session, 10));
  const shift = {
    by: 0,
    reach: null,
    reshape: ({ owner, key }: { owner: never; key: Key }) => ({ owner, key: { ...key, value: 2e9 } }),
  };
  drag.move(shift as never);
  expect(session.document.unsaved.value).toEqual([]);
  expect(await drag.commit(shift as never)).toBeNull();
  expect(fake.made).toEqual([]);
  expect(failed).toMatchObject([{ message: "The values would be too large." }]);
});
