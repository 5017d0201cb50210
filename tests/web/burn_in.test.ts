import { burnIn, FACTS, timeCode, type Filmed } from "@/model/burn_in";

const LENS = {
  lensName: "Biotar 58/2",
  lensModel: "prescription",
  focalLengthMm: 58.04,
  stop: 2.8,
  marking: "f",
  transmittance: 1,
  focusDistanceM: 3.424,
} as const;
const FILMED: Filmed = {
  shot: "night tram",
  camera: "main_cam",
  time: 1500,
  framesPerSecond: 24,
  lens: LENS,
  film: "Vision3 500T",
  revision: "5a302e56c1d04f7b",
  date: new Date(2026, 10, 8),
};

describe("burn-ins", () => {
  it("have a corner each", () => {
    expect(burnIn(FACTS, FILMED, "m")).toEqual([
      { corner: "top-left", lines: ["night tram", "main_cam"] },
      { corner: "top-right", lines: ["Biotar 58/2", "58 mm · f/2.8 · focus 3.42 m"] },
      { corner: "bottom-left", lines: ["Vision3 500T", "rev 5a302e56 · 2026-11-08"] },
      { corner: "bottom-right", lines: ["frame 1500 · 00:01:02:12"] },
    ]);
  });

  it("leave out what is not chosen, and what there is not", () => {
    expect(burnIn([], FILMED, "m")).toEqual([]);
    const unfilmed = { ...FILMED, lens: null, film: "", revision: "", time: -3 };
    expect(burnIn(FACTS, unfilmed, "m")).toEqual([
      { corner: "top-left", lines: ["night tram", "main_cam"] },
      { corner: "bottom-left", lines: ["2026-11-08"] },
      { corner: "bottom-right", lines: ["frame -3"] },
    ]);
  });

  it("have the stop that counts, and the unit that is chosen", () => {
    const said = (lens: Partial<Filmed["lens"]>): string | undefined =>
      burnIn(["stop", "focus"], { ...FILMED, lens: { ...LENS, ...lens } }, "ft")[0]?.lines[0];
    expect(said({})).toBe("f/2.8 · focus 11′ 3″");
    expect(said({ transmittance: 0.25 })).toBe("T 5.6 · focus 11′ 3″");
    expect(said({ marking: "t", focusDistanceM: Infinity })).toBe("T 2.8 · focus ∞");
    expect(said({ stop: 0, transmittance: 0.5 })).toBe("pinhole · focus 11′ 3″");
  });

  it("count frames in time codes as movies do", () => {
    expect(timeCode(0, 24)).toBe("00:00:00:00");
    expect(timeCode(24 * 3600 + 23.5, 24)).toBe("01:00:00:23");
    expect(timeCode(30, 29.97)).toBe("00:00:01:00");
    expect(timeCode(24 * 86400, 24)).toBe("");
  });
});
