import { F_NUMBERS, FOCAL_LENGTHS_MM, FOCUS_DISTANCES_M, WEIGHTS } from "@/model/scale";

describe.each([
  ["f-number", F_NUMBERS, [0.7, 1.4, 2.8, 11, 32]],
  ["focal length", FOCAL_LENGTHS_MM, [8, 24, 50, 135, 400]],
  ["focus distance", FOCUS_DISTANCES_M, [0.05, 0.8, 3, 40, 200, Infinity]],
  ["weight", WEIGHTS, [0, 0.25, 0.5, 1]],
] as const)("the slider of %s", (_, scale, values) => {
  it.each(values)("has a place for %f that stands for it", (value) => {
    const position = scale.toPosition(value);
    expect(position).toBeGreaterThanOrEqual(0);
    expect(position).toBeLessThanOrEqual(1);
    const read = scale.toValue(position);
    if (value === Infinity) expect(read).toBe(Infinity);
    else expect(Math.abs(read - value)).toBeLessThanOrEqual(0.04 * value + 1e-9);
  });

  it("goes up from left to right", () => {
    const along = Array.from({ length: 101 }, (_unused, at) => scale.toValue(at / 100));
    expect(along).toEqual(along.toSorted((a, b) => a - b));
  });

  it("an arrow key always changes the value, and back", () => {
    for (const value of values.slice(1, -1)) {
      expect(scale.step(value, 1)).toBeGreaterThan(value);
      expect(scale.step(value, -1)).toBeLessThan(value);
    }
  });
});

describe("lens scales", () => {
  it("a stop is as far from f/1.4 to f/2 as from f/11 to f/16", () => {
    const far = (a: number, b: number): number => F_NUMBERS.toPosition(b) - F_NUMBERS.toPosition(a);
    expect(far(1.4, 2.8)).toBeCloseTo(far(8, 16), 9);
  });

  it("three arrow keys are one stop", () => {
    expect(F_NUMBERS.step(F_NUMBERS.step(F_NUMBERS.step(2, 1), 1), 1)).toBeCloseTo(2.8, 1);
  });

  it("the focus ring ends at infinity, and comes back from it", () => {
    expect(FOCUS_DISTANCES_M.step(200, 1)).toBe(Infinity);
    expect(FOCUS_DISTANCES_M.step(Infinity, -1)).toBe(200);
    expect(FOCUS_DISTANCES_M.step(Infinity, 1)).toBe(Infinity);
    expect(FOCUS_DISTANCES_M.toValue(1)).toBe(Infinity);
  });
});
