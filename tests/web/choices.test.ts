import { chooseVariant, showPayload } from "@/model/choices";
import { primName } from "@/model/shot";

const SET = { prim: "/World/Tram", name: "livery", variants: ["night", "day"], selection: "night", edited: false };
const PAYLOAD = { prim: "/World/Tram", shown: true, edited: false };

describe("choices of a shot", () => {
  it("a prim is called by the last part of its path", () => {
    expect(primName("/World/Set/Tram")).toBe("Tram");
  });

  it.each([
    ["day", "Tram: livery day"],
    ["", "Tram: livery none"],
    [null, "Tram: livery as in the shot"],
  ])("variant %s is an edit of that label", (variant, label) => {
    const change = { type: "chooseVariant", prim: "/World/Tram", variantSet: "livery", variant };
    expect(chooseVariant(SET, variant)).toEqual({ label, change });
  });

  it.each([
    [true, "Tram: shown"],
    [false, "Tram: left out"],
    [null, "Tram: as in the shot"],
  ])("a payload that is shown (%s) is an edit of that label", (shown, label) => {
    expect(showPayload(PAYLOAD, shown)).toEqual({ label, change: { type: "showPayload", prim: "/World/Tram", shown } });
  });
});
