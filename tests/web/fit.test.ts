import { errorOf, fitKeys, type Fit, type Sample } from "@/model/fit";
import { valueAt } from "@/model/spline";

const [FAR_M, TOLERANCE] = [60, 0.02];

/** A sample on each frame from 1 on, of distances by the share of the whole way. */
function sampled(frames: number, distanceAt: (share: number) => number): Sample[] {
  return Array.from({ length: frames }, (_frame, at) => ({ time: at + 1, distanceM: distanceAt(at / (frames - 1)) }));
}

/** Largest error of the curve that USD makes of keys. */
function worst({ keys }: Fit, samples: readonly Sample[]): number {
  return Math.max(...samples.map(({ time, distanceM }) => errorOf(valueAt(keys, time) ?? NaN, distanceM, FAR_M)));
}

function ease(t: number): number {
  return t * t * (3 - 2 * t);
}

/** A rack as a ring turns: even in the inverse of the distance, at an ease. */
function rack(from: number, to: number, share: number): number {
  return 1 / (1 / from + (1 / to - 1 / from) * share);
}

/** A hand's tremble: a noise that is the same each time, -1 to 1. */
function tremble(share: number): number {
  const bits = Math.sin(share * 12_345.6) * 43_758.5;
  return 2 * (bits - Math.floor(bits)) - 1;
}

describe("the keys of a recorded focus", () => {
  it("are one where nothing moves", () => {
    expect(
      fitKeys(
        sampled(96, () => 2),
        TOLERANCE,
        FAR_M,
      ),
    ).toEqual({
      keys: [{ time: 1, value: 2, interpolation: "linear" }],
      error: 0,
    });
  });

  it("of a straight line are its two ends", () => {
    const samples = sampled(96, (share) => 1 + 3 * share);
    const fit = fitKeys(samples, TOLERANCE, FAR_M);
    expect(fit.keys.map(({ time, interpolation }) => [time, interpolation])).toEqual([
      [1, "linear"],
      [96, "linear"],
    ]);
    expect(fit.keys.map(({ value }) => Number(value.toFixed(6)))).toEqual([1, 4]);
    expect(fit.error).toBeLessThan(1e-6);
  });

  it.each<[string, number, (share: number) => number]>([
    ["an even turn of the ring", 2, (share) => rack(1, 2.5, share)],
    ["a smooth rack", 4, (share) => rack(1, 4, ease(share))],
    ["a long smooth rack", 6, (share) => rack(0.6, 20, ease(share))],
    ["a rack between two holds", 6, (share) => rack(2, 6, ease(Math.min(Math.max(3 * share - 1, 0), 1)))],
    ["a rack there and back", 6, (share) => rack(1.5, 5, Math.sin(Math.PI * share) ** 2)],
    ["a corner", 3, (share) => (share < 0.5 ? 2 : 2 + 2 * (share - 0.5))],
    ["a rack to infinity", 8, (share) => rack(2, Infinity, ease(share))],
    ["a hand that trembles", 8, (share) => rack(1, 4, ease(share)) * (1 + 0.008 * tremble(share))],
  ])("of %s are %i at most", (_name, most, distanceAt) => {
    const samples = sampled(96, distanceAt);
    const fit = fitKeys(samples, TOLERANCE, FAR_M);
    expect(fit.keys.length).toBeLessThanOrEqual(most);
    expect(fit.error).toBeLessThanOrEqual(TOLERANCE);
    expect(worst(fit, samples)).toBeCloseTo(fit.error, 5);
  });
});

describe("the error of few keys", () => {
  it("keeps to a finer tolerance, with more keys", () => {
    const samples = sampled(200, (share) => rack(0.7, 8, ease(share)));
    const fits = [0.05, 0.02, 0.005, 0.001].map((tolerance) => fitKeys(samples, tolerance, FAR_M));
    const counts = fits.map(({ keys }) => keys.length);
    expect(counts).toEqual(counts.toSorted((a, b) => a - b));
    for (const [at, tolerance] of [0.05, 0.02, 0.005, 0.001].entries())
      expect(fits[at]?.error).toBeLessThanOrEqual(tolerance);
  });

  it("of a jump is within it", () => {
    const samples = sampled(60, (share) => (share < 0.5 ? 2 : 3));
    const fit = fitKeys(samples, TOLERANCE, FAR_M);
    expect(worst(fit, samples)).toBeLessThanOrEqual(TOLERANCE);
    expect(fit.keys.length).toBeLessThanOrEqual(4);
  });

  it("of one sample, and of two, is none", () => {
    expect(fitKeys([{ time: 5, distanceM: 3 }], TOLERANCE, FAR_M).keys).toHaveLength(1);
    const two = fitKeys(
      sampled(2, (share) => 1 + share),
      TOLERANCE,
      FAR_M,
    );
    expect(two.keys.map(({ time, value }) => [time, Number(value.toFixed(6))])).toEqual([
      [1, 1],
      [2, 2],
    ]);
  });
});

describe("the keys of a focus at infinity", () => {
  it.each([1, 40])("are one for %i samples", (frames) => {
    const samples = Array.from({ length: frames }, (_frame, at) => ({ time: at + 1, distanceM: Infinity }));
    const fit = fitKeys(samples, TOLERANCE, FAR_M);
    expect(fit.keys.map(({ time, interpolation }) => [time, interpolation])).toEqual([[1, "linear"]]);
    expect(fit.keys[0]?.value).toBeGreaterThan(FAR_M / TOLERANCE);
    expect(fit.error).toBeCloseTo(errorOf(fit.keys[0]?.value ?? NaN, Infinity, FAR_M), 9);
  });
});

it("the keys of a long recording are found", () => {
  const distanceAt = (at: number): number => (at < 140 ? 1 + (at % 2) : 2);
  const samples = Array.from({ length: 130_000 }, (_frame, at) => ({ time: at + 1, distanceM: distanceAt(at) }));
  expect(fitKeys(samples, TOLERANCE, FAR_M).keys.at(-1)).toMatchObject({ time: 130_000, value: 2 });
});
