import { brightnessOf } from "@/model/brightness";
import type { ExposureReadout, ExposureSettings, FilmSettings } from "@/model/photography";
import { FILM_DEFAULTS } from "@/model/settings.gen";
import { EXPOSURE, READOUT } from "./exposures";

/** As a camera on a set. */
const SET: Partial<ExposureSettings> = { exposureTimeS: 1 / 48, iso: 800, exposureStop: "iris", stopMarking: "t" };
function said(
  exposure: Partial<ExposureSettings>,
  readout: Partial<ExposureReadout> = {},
  film: Partial<FilmSettings> = {},
): readonly [string, string] {
  const { by, parts } = brightnessOf({
    exposure: { ...EXPOSURE, ...exposure },
    readout: { ...READOUT, ...readout },
    film: { ...FILM_DEFAULTS, ...film } as unknown as FilmSettings,
  });
  return [by, parts.map(({ text }) => text).join(", ")];
}

describe("the brightness", () => {
  it("is the scene's where USD's defaults expose nothing", () => {
    expect(said({})).toEqual(["scene", ""]);
    expect(said({ compensationStops: 0.5, neutralDensity: 0.3 })).toEqual(["scene", "ND 0.3, +0.5 stops"]);
    expect(said({ transmittance: 0.5 })).toEqual(["scene", "glass −1 stop"]);
  });

  it("is that of shutter, ISO, stop, filter and compensation", () => {
    const [by, parts] = said({ ...SET, neutralDensity: 0.6, compensationStops: 1 / 3 }, { fStop: 1.5 });
    expect([by, parts]).toEqual(["camera", "shutter 180°, ISO 800, T 1.5, ND 0.6, +0.3 stops"]);
  });

  it("says the stop that the light goes by", () => {
    expect(said({ iso: 200 }, { fStop: 1 })[1]).toContain("f/1");
    expect(said({ ...SET, stopMarking: "f", transmittance: 0.64 }, { fStop: 1.2 })[1]).toContain("T 1.5");
    expect(said({ ...SET, transmittance: 0.64 }, { fStop: 1.2 })[1]).toContain("T 1.2");
  });

  it("says the time where the shutter is open for another", () => {
    expect(said({ iso: 200 })[1]).toContain("exposed 1 s");
    expect(said({ ...SET, shutterAngleDeg: 0 }, { shutterTimeS: 0 })[1]).toContain("exposed 1/48 s");
  });

  it("is the meter's where it decides, whatever else is set", () => {
    expect(said({ ...SET, meteringMode: "center" })).toEqual(["meter", "centre"]);
    const spot = { meteringMode: "spot", meteringFocusPoint: "pip", meteringCompensationStops: 1 } as const;
    expect(said({ ...SET, ...spot })).toEqual(["meter", "spot on pip, +1 stop"]);
  });

  it("leaves out nothing that darkens", () => {
    expect(said(SET, { bellowsFactor: 2 })[1]).toContain("bellows −1 stop");
    expect(said({ ...SET, responsivity: 0.5 })[1]).toContain("responsivity 0.5");
    expect(said(SET, {}, { process: "negative", push: 1 })[1]).toContain("pushed 1 stop");
    expect(said(SET, {}, { process: "none", push: 1 })[1]).not.toContain("pushed");
  });

  it("each value has the setting of its control", () => {
    const { parts } = brightnessOf({
      exposure: { ...EXPOSURE, ...SET, responsivity: 0.5 },
      readout: READOUT,
      film: FILM_DEFAULTS as unknown as FilmSettings,
    });
    expect(parts.map(({ setting }) => setting)).toEqual(["shutterClose", "iso", "fStop", null]);
  });
});
