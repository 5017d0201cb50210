import { setExposure, setFilm, toggleSettingKey } from "@/model/changes";
import type { Keyed } from "@/model/keys";
import {
  agrees,
  formatStops,
  formatTime,
  groupedFilms,
  matchShutter,
  parseShutter,
  setExposureStop,
  setShutter,
  type ExposureSettings,
  type FilmSettings,
  type FilmSummary,
} from "@/model/photography";
import { scaleOf } from "@/model/scale";
import { EXPOSURE_SLIDERS } from "@/model/settings.gen";
import { EXPOSURE, READOUT } from "./exposures";

const ISOS = scaleOf(EXPOSURE_SLIDERS.iso.slider);
/** How bright the picture is, by UsdGeomCamera's law; the stop of the iris where that exposes. */
function scale(exposure: Partial<ExposureSettings>, iris = 1): number {
  const e = { ...EXPOSURE, ...exposure };
  const stop = e.exposureStop === "iris" ? iris : e.exposureFStop;
  return (e.exposureTimeS * e.iso * 2 ** e.compensationStops) / (100 * stop ** 2);
}

function keyed(...names: string[]): Keyed {
  return Object.fromEntries(names.map((name) => [name, [{ time: 1, value: 0, interpolation: "linear" as const }]]));
}

describe("the shutter", () => {
  it("exposes for as much longer as it is open", () => {
    const half = setShutter(90, EXPOSURE);
    expect(half).toEqual({ shutterAngleDeg: 90, exposureTimeS: 0.5 });
    expect(scale(half) / scale({})).toBeCloseTo(0.5);
    expect(setShutter(180, { ...EXPOSURE, shutterAngleDeg: 0 }).exposureTimeS).toBe(1);
    expect(setShutter(0, EXPOSURE).exposureTimeS).toBe(1);
  });

  it("agrees with the exposure, or is made to without a change of the picture", () => {
    expect(agrees(EXPOSURE, READOUT)).toBe(false);
    const matched = matchShutter(EXPOSURE, READOUT);
    expect(agrees({ ...EXPOSURE, ...matched }, READOUT)).toBe(true);
    expect(scale(matched)).toBeCloseTo(scale({}));
    expect(agrees(EXPOSURE, { ...READOUT, shutterTimeS: 0 })).toBe(true);
  });

  it("is typed as an angle or as a time", () => {
    expect(parseShutter("172.8°", 24)).toBeCloseTo(172.8);
    expect(parseShutter("90", 24)).toBe(90);
    expect(parseShutter("1/48 s", 24)).toBeCloseTo(180);
    expect(parseShutter("1/50", 25)).toBeCloseTo(180);
    expect(parseShutter("0,02 s", 25)).toBeCloseTo(180);
    for (const nonsense of ["", "fast", "1/0", "-90", "90°°"]) expect(parseShutter(nonsense, 24)).toBeNull();
  });
});

describe("the stop", () => {
  it("is handed from the exposure to the iris and back without a change of the picture", () => {
    const byIris = setExposureStop("iris", EXPOSURE, 2.8);
    expect(scale(byIris, 2.8)).toBeCloseTo(scale({}));
    const back = setExposureStop("exposure", { ...EXPOSURE, ...byIris }, 2.8);
    expect(scale({ ...byIris, ...back })).toBeCloseTo(scale({}));
    expect(setExposureStop("iris", EXPOSURE, 0)).toMatchObject({ compensationStops: 0 }); // a pinhole
  });
});

describe("edits", () => {
  it("what is keyed gets a key at the time, the rest changes for the whole shot", () => {
    expect(setExposure({ iso: 200 }, 5, EXPOSURE)).toEqual([{ type: "setExposure", values: { iso: 200 } }]);
    expect(setExposure({ iso: 200 }, 5, { ...EXPOSURE, keys: keyed("iso") })).toMatchObject([{ values: { time: 5 } }]);
    const film = { keys: keyed("push") } as unknown as FilmSettings;
    expect(setFilm({ push: 1 }, 5, film)).toMatchObject([{ values: { time: 5 } }]);
  });

  it("the angle of a shutter has its keys where it closes", () => {
    const animated = { ...EXPOSURE, keys: keyed("shutterClose") };
    expect(setExposure({ shutterAngleDeg: 90 }, 5, animated)).toMatchObject([{ values: { time: 5 } }]);
  });

  it("the diamond sets a key with the value that is there, or removes it", () => {
    const [on] = toggleSettingKey("push", 0.5, 5, {});
    expect(on).toMatchObject({ type: "keySetting", setting: "push", key: { time: 5, value: 0.5 } });
    const [off] = toggleSettingKey("push", 0.5, 1, keyed("push"));
    expect(off).toEqual({ type: "unkeySetting", setting: "push", time: 1 });
    expect(toggleSettingKey("focusDistanceM", Infinity, 5, {})).toMatchObject([{ key: { value: 1e5 } }]);
    expect(toggleSettingKey("solveStop", 1, 5, {})).toMatchObject([{ key: { interpolation: "held" } }]);
  });
});

describe("words", () => {
  it("times and stops are said as photographers do", () => {
    expect([1 / 48, 1 / 8000, 0.5, 2, 30, 0].map(formatTime)).toEqual([
      "1/48 s",
      "1/8000 s",
      "0.5 s",
      "2 s",
      "30 s",
      "a moment",
    ]);
    expect([1, -0.66, 0, 0.01].map(formatStops)).toEqual(["+1", "−0.7", "±0", "±0"]);
  });

  it("ISO goes by the dial, a third of a stop at a time", () => {
    const dial = [100, 125, 160, 200, 250, 320, 400, 500, 640, 800, 1000];
    for (const [at, speed] of dial.slice(0, -1).entries()) expect(ISOS.step(speed, 1)).toBe(dial[at + 1]);
    expect(ISOS.toValue(ISOS.toPosition(800))).toBe(800);
  });
});

describe("stocks", () => {
  it("are grouped by what they are, prints left out", () => {
    const film = (name: string, process: FilmSummary["process"], kind: FilmSummary["kind"]): FilmSummary => ({
      name,
      title: name,
      kind,
      process,
      speed: 100,
      balanceK: null,
      description: "",
      sheet: "",
    });
    const groups = groupedFilms([
      film("a", "reversal", "camera"),
      film("b", "negative", "print"),
      film("c", "monochrome", "camera"),
    ]);
    expect(groups.map(([label, members]) => [label, members.map(({ name }) => name)])).toEqual([
      ["Colour negative", []],
      ["Reversal", ["a"]],
      ["Black and white", ["c"]],
    ]);
  });
});
