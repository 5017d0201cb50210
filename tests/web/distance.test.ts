import { axisFraction, distanceAxis, formatDistance, formatMark, inverse, parseDistance } from "@/model/distance";

describe("distances as people write them", () => {
  it.each([
    ["2.5", "m", 2.5],
    ["2,5 m", "m", 2.5],
    ["85 cm", "m", 0.85],
    ["300mm", "ft", 0.3],
    ["10' 6\"", "m", 3.2004],
    ["10′6″", "ft", 3.2004],
    ["6 in", "m", 0.1524],
    ["10", "ft", 3.048],
    ["∞", "m", Infinity],
    [" inf ", "ft", Infinity],
  ] as const)("%s in %s is %f m", (text, unit, metres) => {
    expect(parseDistance(text, unit)).toBeCloseTo(metres, 9);
  });

  it.each(["", "0", "-2", "far", "2 m 3", "1e9999", "NaN", "'", "."])("%j is no distance", (text) => {
    expect(parseDistance(text, "m")).toBeNull();
  });

  it("shows infinity as ∞ and never as a number", () => {
    expect(formatDistance(Infinity, "m")).toBe("∞");
    expect(formatDistance(Infinity, "ft")).toBe("∞");
  });

  it("shows about three digits", () => {
    expect([0.3777, 2.416, 37.72, 1234.5].map((d) => formatDistance(d, "m"))).toEqual([
      "0.378 m",
      "2.42 m",
      "37.7 m",
      "1235 m",
    ]);
  });

  it("inches carry into feet", () => {
    expect(formatDistance(0.3048 * 5.999, "ft")).toBe("6′ 0″");
    expect(formatDistance(0.3048 * 2.9999, "ft")).toBe("3′ 0″");
    expect(formatMark(3.048, "ft")).toBe("10′");
  });

  it.each([0.4, 1, 2.5, 12, 80])("what is shown of %f m reads back to within what is shown", (metres) => {
    for (const unit of ["m", "ft"] as const) {
      const read = parseDistance(formatDistance(metres, unit), unit) ?? NaN;
      expect(Math.abs(read - metres)).toBeLessThan(Math.max(0.005, 0.0051 * metres, unit === "ft" ? 0.013 : 0));
    }
  });
});

describe("the reciprocal axis", () => {
  it("goes by inverse depth, which infinity has 0 of", () => {
    expect([0.5, 4, Infinity].map(inverse)).toEqual([2, 0.25, 0]);
  });

  it("holds all that it was made for, near at 0 and far at 1", () => {
    const axis = distanceAxis([0.8, 2, 9, Infinity], "m");
    const places = [0.8, 2, 9, Infinity].map((d) => axisFraction(axis, d));
    expect(places).toEqual(places.toSorted((a, b) => a - b));
    expect(Math.min(...places)).toBeGreaterThan(0);
    expect(Math.max(...places)).toBeLessThan(1);
  });

  it("depth of field is as high wherever the lens is focused", () => {
    const axis = distanceAxis([1, 10], "m");
    const height = (focus: number): number =>
      axisFraction(axis, 1 / (inverse(focus) - 0.02)) - axisFraction(axis, 1 / (inverse(focus) + 0.02));
    expect(height(2)).toBeCloseTo(height(8), 9);
  });

  it("labels are inside it, apart from each other, and say ∞ where it reaches it", () => {
    const axis = distanceAxis([0.5, Infinity], "m", 6);
    const places = axis.ticks.map((tick) => axisFraction(axis, tick));
    expect(axis.ticks.at(-1)).toBe(Infinity);
    expect(axis.ticks.length).toBeLessThanOrEqual(8);
    expect(axis.ticks.length).toBeGreaterThan(2);
    places.forEach((place, at) => {
      expect(place).toBeGreaterThanOrEqual(0);
      expect(place).toBeLessThanOrEqual(1);
      if (at > 0) expect(place - (places[at - 1] ?? 0)).toBeGreaterThan(0.1);
    });
  });

  it("a curve that does not move, or is not there, still has an axis", () => {
    for (const distances of [[3, 3, 3], [Infinity], []]) {
      const axis = distanceAxis(distances, "m");
      expect(axis.nearW).toBeGreaterThan(axis.farW);
    }
  });
});
