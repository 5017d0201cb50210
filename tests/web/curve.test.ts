import { distancesOf, pointNames, sampleAt, type Curve } from "@/model/curve";

const curve: Curve = [1, 2, 4, 8].map((time) => ({
  time,
  fStop: 2,
  focalLengthMm: 50,
  focusDistanceM: time,
  nearM: time - 0.1,
  farM: Infinity,
  hyperfocalM: 60,
  source: "points",
  reason: "",
  points: [
    { name: "a", depthM: time === 4 ? null : 3, share: 1 },
    { name: "b", depthM: -2, share: 0 },
  ],
}));

describe("the focus curve", () => {
  it("has a sample for its own times alone", () => {
    expect([1, 2, 4, 8].map((time) => sampleAt(curve, time)?.focusDistanceM)).toEqual([1, 2, 4, 8]);
    expect([0, 3, 9].map((time) => sampleAt(curve, time))).toEqual([null, null, null]);
    expect(sampleAt([], 1)).toBeNull();
  });

  it("is drawn to hold the focus and the points that are in front of the camera", () => {
    expect(new Set(distancesOf(curve))).toEqual(new Set([1, 2, 3, 4, 8]));
  });

  it("names each point once", () => {
    expect(pointNames(curve)).toEqual(["a", "b"]);
  });
});
