import type { KeyOwner, KeyStack } from "@/model/key_lanes";
import type { Key } from "@/model/keys";
import { respanned, valueSpanOf } from "@/model/value_scale";

/** Stacks of one key each. */
function stacksOf(owner: KeyOwner, values: readonly number[], more: Partial<Key> = {}): KeyStack[] {
  return values.map((value, time) => ({
    id: `lane@${time}`,
    lane: "lane",
    time,
    keys: [{ owner, key: { time, value, interpolation: "auto", ...more } }],
  }));
}

function valuesOf(stacks: readonly KeyStack[]): number[] {
  return stacks.flatMap(({ keys }) => keys.map(({ key }) => key.value));
}

describe("values that are spread over another span", () => {
  it("keep their places in stops, on the focus ring, or in plain numbers", () => {
    expect(valuesOf(respanned(stacksOf({ setting: "fStop" }, [2, 4, 8]), 2, 32))[1]).toBeCloseTo(8);
    expect(valuesOf(respanned(stacksOf({ setting: "focusDistanceM" }, [1, 2, 4]), 1, 2))[1]).toBeCloseTo(1.5);
    expect(valuesOf(respanned(stacksOf({ setting: "tiltDeg" }, [-2, 0, 4]), -1, 2))).toEqual([-1, 0, 2]);
  });

  it("end exactly where it is said, and one value for all comes to the new end", () => {
    const [low, , high] = valuesOf(respanned(stacksOf({ setting: "fStop" }, [2.8, 4, 5.6]), 16, 1.4));
    expect([low, high]).toEqual([1.4, 16]);
    expect(valuesOf(respanned(stacksOf({ setting: "tiltDeg" }, [3, 3]), 3, 5))).toEqual([5, 5]);
    expect(valuesOf(respanned(stacksOf({ setting: "tiltDeg" }, [3, 3]), 1, 3))).toEqual([1, 1]);
  });

  it("take the slopes of their handles along", () => {
    const tangents = { inSlope: 1, inWidth: 0.3, outSlope: -2, outWidth: 0.3 };
    const bezier = { interpolation: "bezier", tangents } as const;
    const [tilted] = respanned(stacksOf({ setting: "tiltDeg" }, [0, 4], bezier), 0, 2);
    expect(tilted?.keys[0]?.key.tangents).toEqual({ ...tangents, inSlope: 0.5, outSlope: -1 });
    const [, opened] = respanned(stacksOf({ setting: "fStop" }, [2, 4], bezier), 2, 8);
    expect(opened?.keys[0]?.key.tangents?.inSlope).toBeCloseTo((1 / 4) * 2 * 8); // twice as many stops, at twice the value
  });

  it("are those of one curve, and no switches", () => {
    const two = [...stacksOf({ setting: "fStop" }, [2, 4]), ...stacksOf({ setting: "tiltDeg" }, [0, 1])];
    expect(valueSpanOf(two)).toBeNull();
    expect(respanned(two, 0, 1)).toBe(two);
    expect(valueSpanOf(stacksOf({ setting: "solveStop" }, [0, 1]))).toBeNull();
    expect(valueSpanOf(stacksOf({ setting: "fStop" }, [2]))).toBeNull();
  });
});
