import { freshName, pullTo, type WeightKey } from "@/model/pull";
import type { Key } from "@/model/keys";
import { keysOf, thingName, type FocusPoint } from "@/model/shot";
import { point, valueAt } from "./points";

/** The points after the keys were set; a new one is there with weight 1. */
function after(points: readonly FocusPoint[], keys: readonly WeightKey[]): Map<string, readonly Key[]> {
  const weights = new Map(points.map((p) => [p.name, [...keysOf(p, "weight")]]));
  for (const { point: name, time, value } of keys) {
    const others = (weights.get(name) ?? []).filter((key) => key.time !== time);
    weights.set(name, [...others, { time, value, interpolation: "linear" }]);
  }
  return weights;
}

/** Who has which share of the focus at a time. */
function shares(weights: Map<string, readonly Key[]>, time: number): Record<string, number> {
  const at = [...weights].map(([name, keys]): [string, number] => [name, valueAt(keys, time, 1)]);
  const sum = at.reduce((total, [, weight]) => total + weight, 0);
  return Object.fromEntries(at.map(([name, weight]) => [name, weight / sum]));
}

const rack = [point("near", { weight: { 30: 1, 60: 0 } }), point("far", { weight: { 30: 0, 60: 1 } })];

describe("a click pulls the focus", () => {
  it("the first point of a shot has it at all times", () => {
    const weights = after([], pullTo("a", 10, []));
    expect([1, 10, 96].map((time) => shares(weights, time).a)).toEqual([1, 1, 1]);
  });

  it("two clicks at two times are a rack between them", () => {
    const first = point("a", { weight: { 10: 1 } });
    const weights = after([first], pullTo("b", 50, [first]));
    expect(shares(weights, 10)).toEqual({ a: 1, b: 0 });
    expect(shares(weights, 50)).toEqual({ a: 0, b: 1 });
    expect(shares(weights, 30)).toEqual({ a: 0.5, b: 0.5 });
    expect(shares(weights, 96)).toEqual({ a: 0, b: 1 });
  });

  it("two clicks at one time: the second has it", () => {
    const first = point("a", { weight: { 10: 1 } });
    const weights = after([first], pullTo("b", 10, [first]));
    expect([1, 10, 96].map((time) => shares(weights, time).b)).toEqual([1, 1, 1]);
  });

  it("what was decided at other times stays", () => {
    const now = rack.map((p) => ({ ...p, settings: { ...p.settings, weight: valueAt(keysOf(p, "weight"), 45, 1) } }));
    const weights = after(now, pullTo("new", 45, now));
    expect(shares(weights, 45)).toEqual({ near: 0, far: 0, new: 1 });
    expect(shares(weights, 30)).toEqual({ near: 1, far: 0, new: 0 });
    expect(shares(weights, 60)).toEqual({ near: 0, far: 1, new: 0 });
    expect(shares(weights, 1).new).toBe(0);
  });

  it("there is someone to focus on at all times between the keys", () => {
    const now = rack.map((p) => ({ ...p, settings: { ...p.settings, weight: valueAt(keysOf(p, "weight"), 10, 1) } }));
    const weights = after(now, pullTo("new", 10, now));
    for (let time = 1; time <= 96; time += 1) {
      const sum = [...weights.values()].reduce((total, keys) => total + valueAt(keys, time, 1), 0);
      expect(sum).toBeGreaterThan(0);
    }
  });

  it("a point that is there already gets it back without new hand-over keys where it had a say", () => {
    const now = rack.map((p) => ({ ...p, settings: { ...p.settings, weight: valueAt(keysOf(p, "weight"), 80, 1) } }));
    expect(pullTo("near", 80, now)).toEqual([
      { point: "near", time: 80, value: 1 },
      { point: "far", time: 80, value: 0 },
    ]);
  });

  it("leaves alone who is switched off for good", () => {
    const off = point("off", {}, { enabled: false });
    expect(pullTo("a", 10, [off])).toEqual([{ point: "a", time: 10, value: 1 }]);
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
  });
});
