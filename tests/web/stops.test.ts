import { F_NUMBERS } from "@/model/scale";
import { detents, formatStop, nearestThird, numberOfT, parseStop, sayStop, stopsOf } from "@/model/stops";

const THIRDS = detents(0.5, 90).map(({ stop }) => stop);

describe("the detents of the stop", () => {
  it("are the thirds as engraved, and each is its own nearest one", () => {
    expect(THIRDS.map(nearestThird)).toEqual(THIRDS);
    expect(detents(1.4, 4).map(({ stop }) => stop)).toEqual([1.4, 1.6, 1.8, 2, 2.2, 2.5, 2.8, 3.2, 3.5, 4]);
    expect(detents(0.7, 32).flatMap(({ stop, isFull }) => (isFull ? [stop] : []))).toEqual([
      ...[0.7, 1, 1.4, 2, 2.8, 4, 5.6, 8, 11, 16, 22, 32],
    ]);
  });

  it("are where the slider stops, from end to end", () => {
    const seen = new Set(Array.from({ length: 1001 }, (_, at) => F_NUMBERS.toValue(at / 1000)));
    expect([...seen]).toEqual(detents(0.7, 32).map(({ stop }) => stop));
  });

  it("are what the arrow keys go to, and no farther than the ends", () => {
    const up = Array.from({ length: 6 }).reduce<number[]>(
      (stops) => [...stops, F_NUMBERS.step(stops.at(-1) ?? 0, 1)],
      [1.4],
    );
    expect(up).toEqual([1.4, 1.6, 1.8, 2, 2.2, 2.5, 2.8]);
    expect([F_NUMBERS.step(2.8, -3), F_NUMBERS.step(2, 5)]).toEqual([2, 3.5]);
    expect([F_NUMBERS.step(32, 1), F_NUMBERS.step(0.7, -1), F_NUMBERS.step(0, 1)]).toEqual([32, 0.7, 0.7]);
  });

  it("are met from between them at the next one", () => {
    expect([F_NUMBERS.step(2.1, 1), F_NUMBERS.step(2.1, -1)]).toEqual([2.2, 2]);
    expect([F_NUMBERS.step(2.75, 1), F_NUMBERS.step(2.75, -1)]).toEqual([2.8, 2.5]);
  });

  it("are none where the scale is free", () => {
    const free = F_NUMBERS.free ?? F_NUMBERS;
    expect(free.toValue(free.toPosition(2.37))).toBe(2.37);
    const next = free.step(2, 1);
    expect(next).toBeGreaterThan(2);
    expect(next).toBeLessThan(2.1);
  });
});

describe("f and T together", () => {
  it("T follows from what the glass passes, and f from T", () => {
    expect(stopsOf(1.4, "f", 0.8).t).toBeCloseTo(1.565, 3);
    expect(numberOfT(1.565, "f", 0.8)).toBeCloseTo(1.4, 3);
    for (const number of THIRDS) {
      const { f, t } = stopsOf(number, "f", 0.9);
      expect(f).toBe(number);
      expect(numberOfT(t, "f", 0.9)).toBeCloseTo(number, 2);
    }
  });

  it("are one number where the barrel has T-stops, as the iris goes by it", () => {
    expect(stopsOf(2.8, "t", 0.8)).toEqual({ f: 2.8, t: 2.8 });
    expect(numberOfT(2.8, "t", 0.8)).toBe(2.8);
  });

  it("no light has no T-stop", () => {
    expect([sayStop(stopsOf(2, "f", 0).t, "t"), numberOfT(2, "f", 0)]).toEqual(["T ∞", null]);
  });

  it("are typed with their letter or without", () => {
    expect(parseStop("2.8")).toEqual({ stop: 2.8, letter: null });
    expect(parseStop(" f/2,8 ")).toEqual({ stop: 2.8, letter: "f" });
    expect(["T3", "t 3", "T/3"].map((text) => parseStop(text))).toEqual(
      [3, 3, 3].map((stop) => ({ stop, letter: "t" })),
    );
    for (const nonsense of ["", "f/", "0", "-2", "x2", "2.8.1", "pinhole"]) expect(parseStop(nonsense)).toBeNull();
  });

  it("are said as on the barrel", () => {
    expect([sayStop(1.4, "f"), sayStop(1.565, "t"), sayStop(0, "f")]).toEqual(["f/1.4", "T 1.56", "pinhole"]);
    expect(["f/22", "f/1.2", "f/1.4"]).toEqual([22.6, 1.26, Math.SQRT2].map(formatStop));
  });
});
