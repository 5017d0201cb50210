import type { Changes } from "@/model/changes";
import {
  hasValue,
  labelOf,
  lanesOf,
  mapKeys,
  mirrored,
  movedStack,
  pasteKeys,
  removeStacks,
  replaceStacks,
  shaped,
  shapeOfAll,
  snapShift,
  stretched,
  valued,
  type KeyShape,
  type KeyStack,
  type OwnedKey,
} from "@/model/key_lanes";
import type { Key } from "@/model/keys";
import type { FocusMode } from "@/model/shot";
import { point } from "./points";

const RANGE = { start: 1, end: 96, framesPerSecond: 24 };

function key(time: number, value = 1, more: Partial<Key> = {}): Key {
  return { time, value, interpolation: "auto", ...more };
}

function stacksOf(...lanes: ReturnType<typeof lanesOf>): readonly KeyStack[] {
  return lanes.flatMap(({ stacks }) => stacks);
}

function moved(stacks: readonly KeyStack[], by: number, mode: FocusMode): Changes {
  return replaceStacks(
    stacks,
    stacks.map((stack) => movedStack(stack, by)),
    mode,
  );
}

function reshaped(stacks: readonly KeyStack[], shape: KeyShape, mode: FocusMode): Changes {
  return replaceStacks(
    stacks,
    mapKeys(stacks, (owned) => shaped(owned, shape)),
    mode,
  );
}

function revalued(stacks: readonly KeyStack[], value: number, mode: FocusMode): Changes {
  const change = (owned: OwnedKey): OwnedKey => valued(owned, value);
  return replaceStacks(stacks, mapKeys(stacks, change), mode);
}

describe("lanes", () => {
  it("are of what has keys: the camera's settings, then the points", () => {
    const lanes = lanesOf(
      [{ fStop: [key(4, 2.8)], tiltDeg: [] }, { iso: [key(1, 800)] }],
      [point("pip", { weight: { 1: 1, 20: 0 }, enabled: { 20: 1 } }), point("mara")],
    );
    expect(lanes.map(({ label, point: name }) => [label, name])).toEqual([
      ["f-number", null],
      ["ISO", null],
      ["pip", "pip"],
    ]);
  });

  it("hold the keys of one time in one stack", () => {
    const [lane] = lanesOf([], [point("pip", { weight: { 1: 1, 20: 0 }, enabled: { 20: 1 } })]);
    expect(lane?.stacks.map(({ time, keys }) => [time, keys.length])).toEqual([
      [1, 1],
      [20, 2],
    ]);
  });

  it("name settings that have no slider in words", () => {
    expect(labelOf({ setting: "shutterClose" })).toBe("Shutter close");
    expect(labelOf({ setting: "exposureTimeS" })).toBe("Exposure time");
  });
});

describe("a move of keys", () => {
  it("takes all of them away before it sets any, so that none falls on another one that moves", () => {
    const stacks = stacksOf(...lanesOf([{ fStop: [key(4, 2.8), key(5, 4)] }], []));
    expect(moved(stacks, 1, "points")).toEqual([
      { type: "unkeySetting", setting: "fStop", time: 4 },
      { type: "unkeySetting", setting: "fStop", time: 5 },
      { type: "keySetting", setting: "fStop", key: key(5, 2.8) },
      { type: "keySetting", setting: "fStop", key: key(6, 4) },
    ]);
    expect(moved(stacks, 0, "points")).toEqual([]);
  });

  it("keeps handles", () => {
    const tangents = { inSlope: 1, inWidth: 2, outSlope: 3, outWidth: 4 };
    const stacks = stacksOf(...lanesOf([{ fStop: [key(4, 2.8, { interpolation: "bezier", tangents })] }], []));
    expect(moved(stacks, 1, "manual")[1]).toMatchObject({ key: { interpolation: "bezier", tangents } });
  });

  it("leaves the focus with the points, whose camera has keys of its own distance", () => {
    const stacks = stacksOf(...lanesOf([{ focusDistanceM: [key(4, 3)] }], []));
    const back = { type: "setFocus", values: { mode: "tiltPlane" } };
    expect(moved(stacks, 1, "tiltPlane").at(-1)).toEqual(back);
    expect(reshaped(stacks, "held", "tiltPlane").at(-1)).toEqual(back);
    expect(moved(stacks, 1, "manual").at(-1)).toMatchObject({ type: "keySetting" });
  });
});

it("keys of points and of settings are removed alike", () => {
  const stacks = stacksOf(...lanesOf([{ fStop: [key(4)] }], [point("pip", { weight: { 1: 1 } })]));
  expect(removeStacks(stacks)).toEqual([
    { type: "unkeySetting", setting: "fStop", time: 4 },
    { type: "unkeyPoint", name: "pip", attribute: "weight", time: 1 },
  ]);
});

it("switches take no other interpolation", () => {
  const stacks = stacksOf(...lanesOf([], [point("pip", { weight: { 1: 1 }, enabled: { 1: 1 } })]));
  expect(shapeOfAll(stacks)).toBe("linear");
  expect(reshaped(stacks, "held", "points")).toEqual([
    { type: "keyPoint", name: "pip", attribute: "weight", key: { time: 1, value: 1, interpolation: "held" } },
  ]);
});

it("handles that are set stay as they are", () => {
  const tangents = { inSlope: 1, inWidth: 2, outSlope: 3, outWidth: 4 };
  const keys = [key(4, 2.8, { interpolation: "bezier", tangents }), key(8)];
  const changes = reshaped(stacksOf(...lanesOf([{ fStop: keys }], [])), "bezier", "manual");
  expect(changes).toMatchObject([{ key: { time: 8, interpolation: "bezier" } }]);
});

it("level handles are a shape of their own, and are handles", () => {
  const stacks = stacksOf(...lanesOf([{ fStop: [key(4), key(8)] }], []));
  const flat = mapKeys(stacks, (owned) => shaped(owned, "flat"));
  expect([shapeOfAll(stacks), shapeOfAll(flat)]).toEqual(["auto", "flat"]);
  const tangents = { inSlope: 0, inWidth: 0, outSlope: 0, outWidth: 0 };
  expect(reshaped(stacks, "flat", "manual")).toMatchObject([
    { key: { time: 4, interpolation: "bezier", tangents } },
    { key: { time: 8, interpolation: "bezier", tangents } },
  ]);
  expect(reshaped(flat, "bezier", "manual")).toEqual([]);
});

it("a distance of infinity is keyed as one far away", () => {
  const stacks = stacksOf(...lanesOf([{ focusDistanceM: [key(4, 3)] }], []));
  expect(revalued(stacks, Infinity, "manual")).toMatchObject([{ key: { value: 100_000 } }]);
});

it("a value is set without moving the key or its interpolation", () => {
  const stacks = stacksOf(...lanesOf([{ fStop: [key(4, 2.8, { interpolation: "held" })] }], []));
  expect(revalued(stacks, 4, "points")).toEqual([
    { type: "keySetting", setting: "fStop", key: { time: 4, value: 4, interpolation: "held" } },
  ]);
});

describe("keys that are stretched or turned round", () => {
  const tangents = { inSlope: 1, inWidth: 2, outSlope: 3, outWidth: 4 };
  const stacks = stacksOf(
    ...lanesOf(
      [{ fStop: [key(4, 2), key(6, 3, { interpolation: "bezier", tangents }), key(12, 5, { interpolation: "held" })] }],
      [],
    ),
  );

  it("keep the first one, and take their handles along", () => {
    const [first, second, last] = stretched(stacks, 2).flatMap(({ keys }) => keys);
    expect([first?.key.time, second?.key.time, last?.key.time]).toEqual([4, 8, 20]);
    expect(second?.key.tangents).toEqual({ inSlope: 0.5, inWidth: 4, outSlope: 1.5, outWidth: 8 });
  });

  it("run backwards through the same values", () => {
    const turned = mirrored(stacks)
      .flatMap(({ keys }) => keys)
      .toSorted((a, b) => a.key.time - b.key.time);
    expect(turned.map((owned) => [owned.key.time, owned.key.value, owned.key.interpolation])).toEqual([
      [4, 5, "bezier"],
      [10, 3, "auto"],
      [12, 2, "held"],
    ]);
    const twice = mirrored(mirrored(stretched(stacks, 1)));
    expect(twice.map(({ time }) => time)).toEqual(stacks.map(({ time }) => time));
  });

  it("turn their handles round", () => {
    const pair = { inSlope: 1, inWidth: 2, outSlope: 3, outWidth: 4 };
    const curved = [
      key(4, 2, { interpolation: "bezier", tangents: pair }),
      key(12, 5, { interpolation: "bezier", tangents: pair }),
    ];
    const [, last] = mirrored(stacksOf(...lanesOf([{ fStop: curved }], []))).flatMap(({ keys }) => keys);
    expect(last?.key).toMatchObject({ time: 4, tangents: { inSlope: -3, inWidth: 4, outSlope: -1, outWidth: 2 } });
  });
});

it("copied keys are set from a time on, in the lanes that they are of", () => {
  const stacks = stacksOf(...lanesOf([{ fStop: [key(4, 2)] }], [point("pip", { weight: { 6: 1 } })]));
  const keys = stacks.flatMap((stack) => stack.keys).filter(hasValue);
  expect(pasteKeys(keys, 20, "points")).toMatchObject([
    { type: "keySetting", setting: "fStop", key: { time: 20, value: 2 } },
    { type: "keyPoint", name: "pip", attribute: "weight", key: { time: 22, value: 1 } },
  ]);
});

describe("a key that is dragged snaps", () => {
  it.each([
    ["to whole frames", 10, 3.4, [], 3],
    ["to a whole frame from between two", 10.25, 1, [], 0.75],
    ["to another key that is near", 10, 3.4, [13.25], 3.25],
    ["to the nearer of two", 10, 3.4, [13, 13.5], 3.5],
    ["to any frame, though something is near", 10, 3.1, [14], 3],
    ["not to where it is", 10.25, 0.1, [10.25], -0.25],
    ["to the last frame", 10, 200, [], 86],
    ["to the first frame", 10, -200, [], -9],
  ])("%s", (_, from, by, targets, expected) => {
    expect(snapShift(RANGE, from, by, targets, 0.5)).toBeCloseTo(expected);
  });

  it("and the last frame is in the shot", () => {
    expect(snapShift({ ...RANGE, end: 10.6 }, 5, 10, [], 0.5)).toBe(5);
  });

  it("and one that is outside of the shot need not come in", () => {
    expect(snapShift(RANGE, 100, -2, [], 0.5)).toBe(-2);
    expect(snapShift(RANGE, 100, 5, [], 0.5)).toBe(0);
  });
});
