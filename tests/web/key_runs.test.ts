import { lanesOf } from "@/model/key_lanes";
import { isOfPlace, nearestOf, runsOf } from "@/model/key_runs";
import { point } from "./points";

const PLACE = [1, 2, 3, 10, 20, 21].map((time) => ({ time, value: 0, interpolation: "held" as const }));

function times(run: readonly { readonly time: number }[]): number[] {
  return run.map(({ time }) => time);
}

describe("runs of keys", () => {
  const [place] = lanesOf([], [], PLACE);
  const stacks = place?.stacks ?? [];

  it("are of keys that are closer than their width", () => {
    expect(runsOf(stacks, 2).map(times)).toEqual([[1, 2, 3], [10], [20, 21]]);
    expect(runsOf(stacks, 1).map(times)).toEqual([[1], [2], [3], [10], [20], [21]]);
    expect(runsOf([], 2)).toEqual([]);
  });

  it("give the nearest key, the earlier one of two", () => {
    expect([2.4, 15, -5, 99].map((time) => nearestOf(stacks, time).time)).toEqual([2, 10, 1, 21]);
  });

  it("are of the camera's place alone", () => {
    const keyed = point("pip", { weight: { 1: 1 } });
    expect(lanesOf([], [keyed], PLACE).map(isOfPlace)).toEqual([false, true]);
  });
});
