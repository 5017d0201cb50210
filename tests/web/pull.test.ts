import { freshName, pulledWeights, pullSpan, weightOf, type Pull, type Weight } from "@/model/pull";
import type { Key } from "@/model/keys";
import { EASES, keysOf, thingName, type FocusPoint } from "@/model/shot";
import { valueAt } from "@/model/spline";
import { point } from "./points";

const RANGE = { start: 1, end: 96, framesPerSecond: 24 };
const FROM: Pull = { reach: "from", frames: 12, ease: "smooth" };
const FRAME: Pull = { ...FROM, reach: "frame" };
const SHOT_LONG: Pull = { ...FROM, reach: "shot" };

/** The points as they are at a time. */
function at(points: readonly FocusPoint[], time: number): FocusPoint[] {
  return points.map((one) => ({
    ...one,
    settings: { ...one.settings, weight: valueAt(keysOf(one, "weight"), time) ?? one.settings.weight },
  }));
}

/** All weights after a pull. */
function pulled(points: readonly FocusPoint[], name: string, time: number, pull: Pull = FROM): Map<string, Weight> {
  const weights = new Map(points.map((one) => [one.name, weightOf(one)]));
  for (const [changed, weight] of pulledWeights(name, time, at(points, time), pull, RANGE))
    weights.set(changed, weight);
  return weights;
}

/** The points with other weights, for the next pull. */
function withWeights(points: readonly FocusPoint[], weights: ReadonlyMap<string, Weight>): FocusPoint[] {
  return [...weights].map(([name, { keys, value }]) => {
    const old = points.find((one) => one.name === name) ?? point(name);
    return { ...old, keys: { ...old.keys, weight: keys }, settings: { ...old.settings, weight: value } };
  });
}

/** Who has which share of the focus at a time. */
function shares(weights: ReadonlyMap<string, Weight>, time: number): Record<string, number> {
  const each = [...weights].map(([name, { keys, value }]): [string, number] => [name, valueAt(keys, time) ?? value]);
  const sum = each.reduce((total, [, weight]) => total + weight, 0);
  return Object.fromEntries(each.map(([name, weight]) => [name, weight / sum]));
}

const all = Array.from({ length: 96 }, (_, frame) => frame + 1);
const rack = [point("near", { weight: { 30: 1, 60: 0 } }), point("far", { weight: { 30: 0, 60: 1 } })];

describe("a click from here", () => {
  it("gives the first point of a shot the focus at all times, without keys", () => {
    expect([...pulled([], "a", 10)]).toEqual([["a", { keys: [], value: 1 }]]);
  });

  it("holds before, goes over in so many frames, and holds after", () => {
    const weights = pulled([point("a")], "b", 40);
    for (const time of all.filter((frame) => frame <= 28)) expect(shares(weights, time)).toEqual({ a: 1, b: 0 });
    expect(shares(weights, 34).b).toBeCloseTo(0.5);
    for (const time of all.filter((frame) => frame >= 40)) expect(shares(weights, time)).toEqual({ a: 0, b: 1 });
  });

  it.each(EASES)("goes over by the ease %s", (ease) => {
    const weights = pulled([point("a")], "b", 40, { ...FROM, ease });
    const early = shares(weights, 31).b ?? NaN;
    // A quarter of the way: u² (3 - 2u) where it is soft at both ends.
    expect(early).toBeCloseTo({ linear: 0.25, smooth: 0.15625, in: 0.0625, out: 0.4375 }[ease], 4);
  });

  it("takes the place of what was in focus until that hands over", () => {
    const weights = pulled(rack, "new", 20);
    expect(shares(weights, 8)).toEqual({ near: 1, far: 0, new: 0 });
    for (const time of [20, 25, 30]) expect(shares(weights, time)).toEqual({ near: 0, far: 0, new: 1 });
    expect(shares(weights, 60)).toEqual({ near: 0, far: 1, new: 0 });
    expect(shares(weights, 45).near).toBe(0);
    expect(weights.get("far")).toEqual(weightOf(rack[1] ?? point("far")));
  });

  it("leaves the focus as it was before it, in the middle of a rack, too", () => {
    const before = new Map(rack.map((one) => [one.name, weightOf(one)]));
    const weights = pulled(rack, "new", 52);
    for (const time of all.filter((frame) => frame <= 40))
      for (const name of ["near", "far"])
        expect(shares(weights, time)[name]).toBeCloseTo(shares(before, time)[name] ?? 0);
    expect(shares(weights, 52).new).toBe(1);
    expect(shares(weights, 60)).toMatchObject({ far: 1, new: 0 });
  });
});

describe("a click from here, in what is there already,", () => {
  it("brings a point that comes later earlier, and it stays", () => {
    const weights = pulled(rack, "far", 20);
    expect(shares(weights, 8)).toEqual({ near: 1, far: 0 });
    for (const time of [20, 30, 45, 60, 96]) expect(shares(weights, time)).toEqual({ near: 0, far: 1 });
  });

  it("at the first frame needs no way", () => {
    const weights = pulled([point("a")], "b", 1);
    for (const time of all) expect(shares(weights, time)).toEqual({ a: 0, b: 1 });
  });

  it("goes over within the shot", () => {
    const weights = pulled([point("a")], "b", 5);
    expect(shares(weights, 1)).toEqual({ a: 1, b: 0 });
    expect(shares(weights, 5)).toEqual({ a: 0, b: 1 });
  });

  it("follows another as often as one likes, and somebody always has the focus", () => {
    let points: FocusPoint[] = [];
    for (const [name, time] of [
      ["a", 10],
      ["b", 50],
      ["c", 80],
      ["d", 30],
      ["a", 66],
    ] as const)
      points = withWeights(points, pulled(points, name, time));
    const weights = new Map(points.map((one) => [one.name, weightOf(one)]));
    for (const [time, name] of [
      [1, "a"],
      [18, "a"],
      [30, "d"],
      [50, "b"],
      [66, "a"],
      [68, "a"],
      [80, "c"],
      [96, "c"],
    ] as const)
      expect(shares(weights, time)[name]).toBeCloseTo(1);
    for (const time of all)
      expect(Object.values(shares(weights, time)).reduce((sum, share) => sum + share, 0)).toBeCloseTo(1);
  });

  it("leaves alone who is switched off for good", () => {
    const off = point("off", {}, { enabled: false });
    expect([...pulledWeights("a", 10, [off], FROM, RANGE).keys()]).toEqual(["a"]);
  });
});

describe("a click from here, where not all points count,", () => {
  const off = point("b", {}, { enabled: false });

  it("takes a point that was off to have had no weight", () => {
    const weights = pulled([point("a"), off], "b", 40);
    for (const time of [1, 28]) expect(shares(weights, time)).toEqual({ a: 1, b: 0 });
    expect(weights.get("b")?.keys.at(-1)?.value).toBe(1);
  });

  it("hands over where another point is switched on", () => {
    const enabled = [
      { time: 1, value: 0, interpolation: "held" as const },
      { time: 60, value: 1, interpolation: "held" as const },
    ];
    const late = { ...point("b"), keys: { enabled }, settings: { ...point("b").settings, enabled: false } };
    expect(pullSpan(null, 20, [point("a"), late], FROM, RANGE)).toMatchObject({ start: 8, arrival: 20, held: 20 });
    expect(shares(pulled([point("a"), late], "c", 20), 60)).toEqual({ a: 0.5, b: 0.5, c: 0 });
  });

  it("goes over in a frame at least", () => {
    const weights = pulled([point("a")], "b", 40, { ...FROM, frames: 0 });
    for (const time of [1, 39]) expect(shares(weights, time)).toEqual({ a: 1, b: 0 });
    expect(shares(weights, 40)).toEqual({ a: 0, b: 1 });
  });
});

describe("the keys of a click", () => {
  it("have handles that reach a third of the way, whatever stood there before", () => {
    const { keys = [] } = pulled([point("a", { weight: { 1: 1, 30: 1, 96: 1 } })], "b", 40).get("a") ?? {};
    const [first, second] = [28, 40].map((time) => keys.find((key) => key.time === time)?.tangents);
    expect([first?.outWidth, second?.inWidth]).toEqual([4, 4]);
  });

  it("leave the curve after the next handover as it was", () => {
    const eased = [{ ...point("near"), keys: { weight: auto([30, 1], [60, 0.5], [90, 0]) } }, point("far")];
    const before = valueAt(keysOf(eased[0] ?? point("near"), "weight"), 67.5);
    expect(valueAt(pulled(eased, "new", 20).get("near")?.keys ?? [], 67.5)).toBeCloseTo(before ?? NaN, 6);
  });
});

function auto(...places: readonly (readonly [number, number])[]): Key[] {
  return places.map(([time, value]) => ({ time, value, interpolation: "auto" }));
}

describe("a click for the whole shot", () => {
  it("takes the focus from all others, and their keys", () => {
    const weights = pulled(rack, "new", 20, SHOT_LONG);
    for (const time of all) expect(shares(weights, time)).toEqual({ near: 0, far: 0, new: 1 });
    expect([...weights.values()].flatMap(({ keys }) => keys)).toEqual([]);
  });
});

describe("a click at this frame", () => {
  it("two clicks at two times are a rack between them", () => {
    const first = withWeights([], pulled([], "a", 10, FRAME));
    const weights = pulled(first, "b", 50, FRAME);
    expect(shares(weights, 10)).toEqual({ a: 1, b: 0 });
    expect(shares(weights, 50)).toEqual({ a: 0, b: 1 });
    expect(shares(weights, 30).b).toBeCloseTo(0.5);
    expect(shares(weights, 96)).toEqual({ a: 0, b: 1 });
  });

  it("drifts from the beginning of the shot and to its end where nothing else was decided", () => {
    const weights = pulled([point("a")], "b", 50, FRAME);
    for (const time of [1, 96]) expect(shares(weights, time)).toEqual({ a: 1, b: 0 });
    expect(shares(weights, 50).b).toBeCloseTo(1);
  });

  it("two clicks at one time: the second has it", () => {
    const first = withWeights([], pulled([], "a", 10, FRAME));
    const weights = pulled(first, "b", 10, FRAME);
    for (const time of all) expect(shares(weights, time).b).toBe(1);
  });

  it("leaves its share at other times to a point that had one", () => {
    const weights = pulled([point("a"), point("b")], "b", 50, FRAME);
    for (const time of [1, 96]) expect(shares(weights, time)).toEqual({ a: 0.5, b: 0.5 });
    expect(shares(weights, 50).b).toBeCloseTo(1);
  });

  it("what was decided at other times stays", () => {
    const weights = pulled(rack, "new", 45, FRAME);
    expect(shares(weights, 45).new).toBeCloseTo(1);
    expect(shares(weights, 30)).toEqual({ near: 1, far: 0, new: 0 });
    expect(shares(weights, 60)).toEqual({ near: 0, far: 1, new: 0 });
    expect(shares(weights, 1).new).toBe(0);
  });

  it("a point that is there already gets it back without new hand-over keys where it had a say", () => {
    const weights = pulledWeights("near", 80, at(rack, 80), FRAME, RANGE);
    expect(weights.get("near")?.keys.map(({ time, value }) => [time, value])).toEqual([
      [30, 1],
      [60, 0],
      [80, 1],
    ]);
  });
});

describe("the times of a click", () => {
  it("are shown before it is made", () => {
    expect(pullSpan(null, 20, at(rack, 20), FROM, RANGE)).toEqual({ start: 8, arrival: 20, held: 30 });
    expect(pullSpan(null, 80, at(rack, 80), FROM, RANGE)).toEqual({ start: 68, arrival: 80, held: null });
    expect(pullSpan(null, 5, [], FROM, RANGE)).toEqual({ start: 1, arrival: 1, held: null });
    expect(pullSpan(null, 20, at(rack, 20), SHOT_LONG, RANGE)).toEqual({ start: 1, arrival: 1, held: null });
    expect(pullSpan(null, 20, at(rack, 20), FRAME, RANGE)).toEqual({ start: 20, arrival: 20, held: 20 });
  });
});

describe("names of new points", () => {
  it.each([
    ["/World/Set/Tram/EnamelTeal", "Tram_EnamelTeal"],
    ["/World/Cube", "Cube"],
    ["/Cube", "Cube"],
  ])("what is at %s is called %s", (path, name) => {
    expect(thingName(path)).toBe(name);
  });

  it("are the target's, made an identifier, and never one that is taken", () => {
    expect(freshName("robot", [])).toBe("robot");
    expect(freshName("robot", ["robot", "robot_2"])).toBe("robot_3");
    expect(freshName("2nd bulb", [])).toBe("_2nd_bulb");
    expect(freshName("", ["focus"])).toBe("focus_2");
    expect(freshName("weight", [])).toBe("weight_2");
    expect(freshName("a".repeat(200), [])).toHaveLength(90);
  });
});
