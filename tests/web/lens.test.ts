import { describedLens, grouped, mountedLens, type LensSummary } from "@/model/lens";
import { toLens, toReadout } from "@/net/convert";

function lens(name: string, model: string): LensSummary {
  const texts = { description: "", keywords: "", section: "", sheet: "" };
  return { name, title: `${name} 50 mm`, model, focalLengthMm: 50, focalLengthRangeMm: null, fStop: 2, ...texts };
}

const READOUT = toReadout({
  camera: "/cam",
  time: 1,
  fStop: 2,
  focalLengthMm: 50,
  focusDistanceM: null,
  focusMode: "tiltPlane",
  nearM: 3,
  farM: null,
  hyperfocalM: null,
  cocLimitMm: 0.03,
  closeFocusM: 0.5,
  pupilToFilmMm: [50, 55],
  source: "camera",
  reason: "",
  note: "",
  tiltDeg: 0,
  swingDeg: 0,
  lensName: "",
  lensModel: "thin",
});
const LENSES = [lens("planar", "prescription"), lens("soft", "seidel")];

describe("the lens on the camera", () => {
  it("is one of the library where both its name and its model are", () => {
    const planar = { ...READOUT, lensName: "planar 50 mm", lensModel: "prescription" };
    expect(mountedLens(planar, LENSES)).toEqual({ kind: "library", lens: LENSES[0] });
    expect(mountedLens({ ...planar, lensModel: "seidel" }, LENSES).kind).toBe("other");
  });

  it("without a name is the thin lens, or one of the shot's own", () => {
    expect(mountedLens(READOUT, LENSES)).toEqual({ kind: "thin" });
    const unnamed = { ...READOUT, lensModel: "prescription" };
    expect(mountedLens(unnamed, LENSES)).toEqual({ kind: "other", title: "A prescription lens" });
  });

  it("has a picture at the service's address", () => {
    const numbers = { focalLengthMm: 50, focalLengthRangeMm: null, fStop: 2 };
    const json = {
      name: "planar 50",
      title: "",
      manufacturer: "",
      model: "thin",
      description: "",
      families: ["normal", "double gauss"],
      year: 1975,
      source: "",
      ...numbers,
    } as const;
    const { section, keywords } = toLens(json, "http://there");
    expect(keywords).toContain("normal double gauss 1975");
    expect(section).toBe("http://there/v1/lenses/planar%2050/section.svg");
  });

  it("tells the range of a zoom", () => {
    const prime = { ...lens("planar", "prescription"), description: "A classic." };
    expect(describedLens(prime)).toBe("A classic.");
    const zoom = { ...prime, focalLengthRangeMm: [72.1, 194.01] } as const;
    expect(describedLens(zoom)).toBe("Zooms from 72.1 to 194 mm. A classic.");
  });

  it("is listed among those of glass, or among the others", () => {
    expect(grouped(LENSES).map(([, members]) => members.map(({ name }) => name))).toEqual([["planar"], ["soft"]]);
  });
});
