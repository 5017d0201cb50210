import { setAttribute, setFocus, setFocusMode, setKind, setLens, toggleKey, type Changes } from "@/model/changes";
import type { Curve, CurveSample } from "@/model/curve";
import type { Keyed } from "@/model/keys";
import type { FocusSettings, Readout } from "@/model/shot";
import { point } from "./points";
import { FOCUS_DEFAULTS } from "@/model/settings.gen";

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
  cocLimitMm: 0.03,
  closeFocusM: 0.5,
  pupilToFilmMm: [50, 55],
  pointSharpness: null,
};

function curve(...samples: Partial<CurveSample>[]): Curve {
  return samples.map((sample, at) => ({ ...readout, time: at + 1, points: [], ...sample }));
}

describe("changes", () => {
  it("what is not keyed changes for the whole shot", () => {
    const change = setAttribute(point("a"), "weight", 0.3, 12);
    expect(change).toEqual([{ type: "alterPoint", name: "a", values: { weight: 0.3 }, time: 12 }]);
  });

  it("what is keyed gets a key at the time", () => {
    const change = setAttribute(point("a", { weight: { 1: 1 } }), "weight", 0.3, 12);
    expect(change).toMatchObject([{ type: "keyPoint", key: { time: 12, value: 0.3, interpolation: "auto" } }]);
  });

  it("a key that is there keeps its interpolation", () => {
    const change = setAttribute(point("a", { weight: { 12: 0.9 } }), "weight", 0.3, 12);
    expect(change).toMatchObject([{ type: "keyPoint", key: { time: 12, value: 0.3, interpolation: "linear" } }]);
  });

  it("the key button keeps the value and only keys it", () => {
    const on = toggleKey(point("a", {}, { weight: 0.7 }), "weight", 5);
    expect(on).toMatchObject([{ type: "keyPoint", key: { time: 5, value: 0.7 } }]);
    const off = toggleKey(point("a", { weight: { 5: 0.7 } }), "weight", 5);
    expect(off).toMatchObject([{ type: "unkeyPoint", time: 5 }]);
  });
});

describe("the lens", () => {
  it("a hand on the focus ring of a camera that points focus sets it for the whole shot", () => {
    const change = setLens("focusDistanceM", 5, 10, readout, curve({}, { focusDistanceM: 4 }), {});
    expect(change).toEqual([{ type: "setCamera", values: { focusDistanceM: 5 } }]);
  });

  it("a still lens changes for the whole shot, a zoom gets a key", () => {
    const still: Changes = [{ type: "setCamera", values: { focalLengthMm: 35 } }];
    expect(setLens("focalLengthMm", 35, 10, readout, curve({}, {}), {})).toEqual(still);
    const zoom = curve({ focalLengthMm: 50 }, { focalLengthMm: 60 });
    expect(setLens("focalLengthMm", 35, 10, readout, zoom, {})).toMatchObject([{ values: { time: 10 } }]);
  });

  it("what is keyed gets a key, though its curve is even", () => {
    const keys: Keyed = { fStop: [{ time: 1, value: 2, interpolation: "auto" }], focusDistanceM: [] };
    const stop: Changes = [{ type: "setCamera", values: { fStop: 8, time: 50 } }];
    expect(setLens("fStop", 8, 50, readout, curve({}, {}), keys)).toEqual(stop);
    expect(setLens("fStop", 8, 50, readout, [], keys)).toEqual(stop);
    const distance: Changes = [{ type: "setCamera", values: { focusDistanceM: 5 } }];
    expect(setLens("focusDistanceM", 5, 50, readout, [], keys)).toEqual(distance);
  });

  it("infinity is the 0 that USD and the service write for it", () => {
    const change = setLens("focusDistanceM", Infinity, 10, readout, [], {});
    expect(change).toEqual([{ type: "setCamera", values: { focusDistanceM: 0 } }]);
  });

  it("saying again who focuses changes nothing", () => {
    expect(setFocusMode("points", "points")).toEqual([]);
  });
});

describe("how the focus is found", () => {
  const settings: FocusSettings = {
    ...FOCUS_DEFAULTS,
    fieldOffsets: [],
    mode: "tiltPlane",
    keys: { maxAngleDeg: [{ time: 1, value: 10, interpolation: "linear" }] },
  };

  it("what is keyed gets a key at the time, the rest changes for the whole shot", () => {
    expect(setFocus({ maxAngleDeg: 5 }, 12, settings)).toEqual([
      { type: "setFocus", values: { maxAngleDeg: 5, time: 12 } },
    ]);
    expect(setFocus({ lagS: 0.2 }, 12, settings)).toEqual([{ type: "setFocus", values: { lagS: 0.2 } }]);
  });

  it("a point that becomes soft is seen to be so, and one that was keeps its blur", () => {
    expect(setKind(point("a"), "soft", 1)).toMatchObject([{ values: { kind: "soft", blurMm: 0.1 } }]);
    const kept = { type: "alterPoint", name: "a", values: { kind: "soft" }, time: 1 };
    expect(setKind(point("a", {}, { blurMm: 0.3 }), "soft", 1)).toEqual([kept]);
    expect(setKind(point("a", {}, { surfaceOffset: 2 }), "soft", 1)).toEqual([kept]);
    expect(setKind(point("a", { blur: { 1: 0 } }), "soft", 1)).toEqual([kept]);
  });

  it("attributes of a point go by the names that its settings have", () => {
    expect(setAttribute(point("a"), "blur", 0.2, 1)).toMatchObject([{ values: { blurMm: 0.2 } }]);
    expect(setAttribute(point("a"), "enabled", 0, 1)).toMatchObject([{ values: { enabled: false } }]);
  });
});
