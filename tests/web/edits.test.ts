import { setAttribute, setFocus, setFocusMode, setKind, setLens, toggleKey } from "@/model/command";
import type { Curve, CurveSample } from "@/model/curve";
import type { FocusSettings, Readout } from "@/model/shot";
import { point } from "./points";

const readout: Readout = {
  fStop: 2,
  focalLengthMm: 50,
  focusDistanceM: 3,
  nearM: 2.9,
  farM: 3.1,
  hyperfocalM: 60,
  source: "points",
  reason: "",
  focusMode: "points",
  note: "",
  tiltDeg: 0,
  swingDeg: 0,
  lensName: "",
  lensModel: "thin",
};

function curve(...samples: Partial<CurveSample>[]): Curve {
  return samples.map((sample, at) => ({ ...readout, time: at + 1, points: [], ...sample }));
}

describe("changes", () => {
  it("what is not keyed changes for the whole shot", () => {
    const change = setAttribute(point("a"), "weight", 0.3, 12);
    expect(change).toEqual([{ do: "changePoint", name: "a", change: { weight: 0.3 } }]);
  });

  it("what is keyed gets a key at the time", () => {
    const change = setAttribute(point("a", { weight: { 1: 1 } }), "weight", 0.3, 12);
    expect(change).toMatchObject([{ do: "setKey", key: { time: 12, value: 0.3, interpolation: "auto" } }]);
  });

  it("a key that is there keeps its interpolation", () => {
    const change = setAttribute(point("a", { weight: { 12: 0.9 } }), "weight", 0.3, 12);
    expect(change).toMatchObject([{ do: "setKey", key: { time: 12, value: 0.3, interpolation: "linear" } }]);
  });

  it("the key button keeps the value and only keys it", () => {
    const on = toggleKey(point("a", {}, { weight: 0.7 }), "weight", 5);
    expect(on).toMatchObject([{ do: "setKey", key: { time: 5, value: 0.7 } }]);
    const off = toggleKey(point("a", { weight: { 5: 0.7 } }), "weight", 5);
    expect(off).toMatchObject([{ do: "removeKey", time: 5 }]);
  });
});

describe("the lens", () => {
  it("a hand on the focus ring of a camera that points focus sets it for the whole shot", () => {
    const change = setLens("focusDistanceM", 5, 10, readout, curve({}, { focusDistanceM: 4 }));
    expect(change).toEqual([{ do: "setLens", change: { focusDistanceM: 5 }, time: null }]);
  });

  it("a still lens changes for the whole shot, a zoom gets a key", () => {
    expect(setLens("focalLengthMm", 35, 10, readout, curve({}, {}))).toMatchObject([{ time: null }]);
    const zoom = curve({ focalLengthMm: 50 }, { focalLengthMm: 60 });
    expect(setLens("focalLengthMm", 35, 10, readout, zoom)).toMatchObject([{ time: 10 }]);
  });

  it("saying again who focuses changes nothing", () => {
    expect(setFocusMode("points", "points")).toEqual([]);
  });
});

describe("how the focus is found", () => {
  const settings: FocusSettings = {
    mode: "tiltPlane",
    solveStop: false,
    smoothingS: 0,
    lagS: 0,
    deadZoneMm: 0,
    nearPriority: 0,
    surfaceExponent: 3,
    expressive: 1,
    tiltDeg: 0,
    swingDeg: 0,
    drivenByPoints: true,
    maxAngleDeg: 15,
    offScreen: "ignore",
    occluded: "keep",
    maxSpeedDegS: 0,
    circleOfConfusionMm: 0,
    keys: { maxAngleDeg: [{ time: 1, value: 10, interpolation: "linear" }] },
  };

  it("what is keyed gets a key at the time, the rest changes for the whole shot", () => {
    expect(setFocus({ maxAngleDeg: 5 }, 12, settings)).toEqual([
      { do: "setFocus", change: { maxAngleDeg: 5 }, time: 12 },
    ]);
    expect(setFocus({ lagS: 0.2 }, 12, settings)).toEqual([{ do: "setFocus", change: { lagS: 0.2 }, time: null }]);
  });

  it("a point that becomes soft is seen to be so, and one that was keeps its blur", () => {
    expect(setKind(point("a"), "soft")).toMatchObject([{ change: { kind: "soft", blurMm: 0.1 } }]);
    const kept = { do: "changePoint", name: "a", change: { kind: "soft" } };
    expect(setKind(point("a", {}, { blurMm: 0.3 }), "soft")).toEqual([kept]);
    expect(setKind(point("a", {}, { surfaceOffset: 2 }), "soft")).toEqual([kept]);
    expect(setKind(point("a", { blur: { 1: 0 } }), "soft")).toEqual([kept]);
  });

  it("attributes of a point go by the names that its settings have", () => {
    expect(setAttribute(point("a"), "blur", 0.2, 1)).toMatchObject([{ change: { blurMm: 0.2 } }]);
    expect(setAttribute(point("a"), "enabled", 0, 1)).toMatchObject([{ change: { enabled: false } }]);
  });
});
