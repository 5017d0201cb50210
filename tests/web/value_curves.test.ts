import { lanesOf, movedStack, replaceStacks, type KeyLane, type KeyStack } from "@/model/key_lanes";
import type { Key } from "@/model/keys";
import { tangentsAt } from "@/model/spline";
import {
  curvesOf,
  exchange,
  keysOfCurve,
  raise,
  raisedValue,
  snapTargets,
  valueAxis,
  withHandle,
  type ValueCurve,
} from "@/model/value_curves";
import { point } from "./points";

function key(time: number, value: number, more: Partial<Key> = {}): Key {
  return { time, value, interpolation: "auto", ...more };
}

function curveOf(setting: string, ...keys: Key[]): ValueCurve {
  const [curve] = curvesOf(lanesOf([{ [setting]: keys }], []));
  if (!curve) throw new Error("There is no curve.");
  return curve;
}

function stackOf(lanes: readonly KeyLane[], time: number): KeyStack {
  const found = lanes.flatMap(({ stacks }) => stacks).find((stack) => stack.time === time);
  if (!found) throw new Error(`There is no key at ${time.toString()}.`);
  return found;
}

describe("curves", () => {
  it("are of each value that has keys, but of no switch", () => {
    const lanes = lanesOf([{ fStop: [key(1, 4)] }], [point("pip", { weight: { 1: 1 }, enabled: { 1: 1 } })]);
    expect(curvesOf(lanes).map(({ label }) => label)).toEqual(["f-number", "pip: Weight"]);
  });

  it("go through a dragged key, and not through the one whose place it takes", () => {
    const lanes = lanesOf([{ fStop: [key(1, 2), key(5, 4), key(9, 8)] }], []);
    const dragged = stackOf(lanes, 9);
    const [curve] = curvesOf(lanes, (stack) => (stack === dragged ? movedStack(stack, -4) : stack));
    expect(curve?.keys.map(({ place, owned }) => [place, owned.key.time, owned.key.value])).toEqual([
      [0, 1, 2],
      [2, 5, 8],
    ]);
  });
});

describe("keys that come to one time", () => {
  it("are one while edits are under way, so that the curve has a slope everywhere", () => {
    const lanes = lanesOf([{ fStop: [key(1, 2), key(5, 4), key(9, 8), key(15, 5)] }], []);
    const [first, second] = [stackOf(lanes, 5), stackOf(lanes, 9)];
    const to = new Map([
      [first, 3],
      [second, -1],
    ]);
    const [curve] = curvesOf(lanes, (stack) => movedStack(stack, to.get(stack) ?? 0));
    const keys = curve ? keysOfCurve(curve) : [];
    expect(keys.map(({ time, value }) => [time, value])).toEqual([
      [1, 2],
      [8, 8],
      [15, 5],
    ]);
    expect(keys.map((_, index) => tangentsAt(keys, index).outSlope).every(Number.isFinite)).toBe(true);
  });
});

describe("the axis of a curve", () => {
  it("counts f-numbers in stops", () => {
    const axis = valueAxis(curveOf("fStop", key(1, 2), key(9, 8)), [], "m", 6);
    expect(axis.fraction(4)).toBeCloseTo((axis.fraction(2) + axis.fraction(8)) / 2);
    expect(axis.ticks.map(({ label }) => label)).toEqual(["2", "2.83", "4", "5.66", "8"]);
  });

  it("is reciprocal for distances, with infinity at hand", () => {
    const axis = valueAxis(curveOf("focusDistanceM", key(1, 1), key(9, 0)), [], "m", 6);
    expect(axis.fraction(2)).toBeCloseTo((axis.fraction(1) + axis.fraction(0)) / 2);
    expect(axis.value(axis.fraction(0) + 0.5)).toBe(100_000);
    expect(axis.value(axis.fraction(1.5))).toBeCloseTo(1.5);
  });

  it("has all of a share in view, and some of what hardly moves", () => {
    const [weight] = curvesOf(lanesOf([], [point("pip", { weight: { 1: 0.5 } })]));
    if (!weight) throw new Error("There is no curve.");
    const axis = valueAxis(weight, [], "m", 5);
    expect([axis.fraction(0) > 0, axis.fraction(1) < 1]).toEqual([true, true]);
    const tilt = valueAxis(curveOf("tiltDeg", key(1, 3)), [], "m", 5);
    expect(tilt.ticks.length).toBeGreaterThan(2);
    expect(tilt.value(tilt.fraction(3))).toBeCloseTo(3);
  });
});

describe("a value that is dragged", () => {
  const curve = curveOf("fStop", key(1, 2), key(9, 8));
  const axis = valueAxis(curve, [], "m", 6);

  it("snaps to third stops, unless it is free", () => {
    const by = axis.fraction(2.5) - axis.fraction(2);
    expect(raisedValue(axis, 2, by, snapTargets(curve, axis, []), 0.05)).toBeCloseTo(2 ** (4 / 3));
    expect(raisedValue(axis, 2, by, snapTargets(curve, axis, []), null)).toBeCloseTo(2.5);
  });

  it("snaps to a subject", () => {
    const distance = curveOf("focusDistanceM", key(1, 1), key(9, 4));
    const ring = valueAxis(distance, [], "m", 6);
    const by = ring.fraction(2.31) - ring.fraction(1);
    expect(raisedValue(ring, 1, by, snapTargets(distance, ring, [2.345]), 0.03)).toBe(2.345);
  });

  it("may go to infinity on a ring", () => {
    const distance = curveOf("focusDistanceM", key(1, 2), key(9, 0));
    const [owned] = distance.keys.map((one) => one.owned);
    expect(owned && raise(distance, () => Infinity)(owned).key.value).toBe(100_000);
  });

  it("stays within its slider, and takes other curves' keys nowhere", () => {
    const lanes = lanesOf([], [point("pip", { weight: { 1: 0.5 }, blur: { 1: 0.02 } })]);
    const [weight] = curvesOf(lanes);
    if (!weight) throw new Error("There is no curve.");
    const stack = stackOf(lanes, 1);
    const raised = stack.keys.map(raise(weight, (value) => value + 3));
    expect(raised.map((owned) => owned.key.value)).toEqual([1, 0.02]);
  });
});

describe("a handle", () => {
  const keys = [key(0, 2), key(10, 4), key(20, 8)];
  const curve = curveOf("fStop", ...keys);

  it("turns with the other one, and keeps its length", () => {
    const changed = withHandle(curve, 1, "out", { time: 14, value: 6 }, false);
    const { inWidth } = tangentsAt(keys, 1);
    expect(changed?.key).toMatchObject({
      interpolation: "bezier",
      tangents: { outSlope: 0.5, outWidth: 4, inSlope: 0.5, inWidth },
    });
  });

  it("turns alone where it is broken, and from then on", () => {
    const broken = withHandle(curve, 1, "in", { time: 8, value: 4 }, true);
    if (!broken) throw new Error("There is no handle.");
    const { outSlope } = tangentsAt(keys, 1);
    expect(broken.key.tangents).toMatchObject({ inSlope: 0, inWidth: 2, outSlope });
    const after = curveOf("fStop", key(0, 2), broken.key, key(20, 8));
    expect(withHandle(after, 1, "in", { time: 8, value: 3 }, false)?.key.tangents).toMatchObject({ outSlope });
  });

  it("stays on its side, and within the segment", () => {
    expect(withHandle(curve, 1, "out", { time: 3, value: 4 }, false)?.key.tangents).toMatchObject({ outWidth: 0.05 });
    expect(withHandle(curve, 1, "out", { time: 99, value: 4 }, false)?.key.tangents).toMatchObject({ outWidth: 10 });
    expect(withHandle(curve, 2, "out", { time: 22, value: 4 }, false)).toBeNull();
  });

  it("turns no farther than the curve may go down", () => {
    const steep = withHandle(curve, 1, "out", { time: 11, value: 1000 }, false)?.key.tangents;
    expect(4 - (steep?.inSlope ?? 0) * (steep?.inWidth ?? 0)).toBeGreaterThan(0.6);
    const down = withHandle(curve, 1, "out", { time: 14, value: -50 }, true)?.key.tangents;
    expect(4 + (down?.outSlope ?? 0) * 4).toBeGreaterThan(0.6);
    const tilt = curveOf("tiltDeg", key(0, 0), key(10, 1), key(20, 3));
    expect(withHandle(tilt, 1, "out", { time: 14, value: -50 }, false)?.key.tangents).toMatchObject({
      outSlope: -12.75,
    });
  });

  it("is an edit of its key alone", () => {
    const lanes = lanesOf([{ fStop: keys }], []);
    const changed = withHandle(curve, 1, "out", { time: 14, value: 6 }, false);
    if (!changed) throw new Error("There is no handle.");
    const stacks = lanes.flatMap((lane) => lane.stacks);
    const after = stacks.map((stack) => ({ ...stack, keys: stack.keys.map(exchange(curve, changed)) }));
    expect(replaceStacks(stacks, after, "manual")).toMatchObject([
      { type: "keySetting", setting: "fStop", key: { time: 10, tangents: { outSlope: 0.5 } } },
    ]);
    expect(keysOfCurve(curve)).toEqual(keys);
  });
});
