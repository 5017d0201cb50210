import { EXPOSURE_SLIDERS, FILM_SLIDERS, FOCUS_SLIDERS } from "@/model/settings.gen";
import { quantityOf } from "@/view/controls/quantity";

describe("a declared setting", () => {
  it("is written with its unit, and 0 by its word", () => {
    const { push, whiteBalanceK, halationAmount, grainAmount } = FILM_SLIDERS;
    expect([0, 1, -1.5].map(quantityOf(push).format)).toEqual(["none", "+1 stops", "−1.5 stops"]);
    expect([0, 3200].map(quantityOf(whiteBalanceK).format)).toEqual(["as lit", "3200 K"]);
    expect(quantityOf(halationAmount).format(0.015)).toBe("1.5 %");
    expect(quantityOf(grainAmount).format(0.5)).toBe("0.5×");
    expect([0, 90].map(quantityOf(FOCUS_SLIDERS.maxSpeedDegS).format)).toEqual(["any", "90 °/s"]);
  });

  it("is read as it is written", () => {
    for (const declared of [...Object.values(FILM_SLIDERS), ...Object.values(FOCUS_SLIDERS)]) {
      const { format, parse, scale } = quantityOf(declared);
      for (const value of [scale.min, scale.toValue(0.5), scale.max])
        expect(parse(format(value)), `${declared.name} ${format(value)}`).toBeCloseTo(value, 1);
    }
    expect(quantityOf(FILM_SLIDERS.halationAmount).parse("2")).toBeCloseTo(0.02);
    expect(quantityOf(EXPOSURE_SLIDERS.compensationStops).parse("+1 stop")).toBe(1);
  });

  it("takes no number below 0 where its slider has none, and no words", () => {
    expect(quantityOf(FILM_SLIDERS.grainAmount).parse("-1")).toBeNull();
    expect(quantityOf(FILM_SLIDERS.push).parse("-1")).toBe(-1);
    expect(quantityOf(FILM_SLIDERS.push).parse("much")).toBeNull();
  });

  it("takes no number that the service refuses", () => {
    const { compensationStops, iso } = EXPOSURE_SLIDERS;
    expect(["1e9", "-101", "100"].map(quantityOf(compensationStops).parse)).toEqual([null, null, 100]);
    expect(["0", "100"].map(quantityOf(iso, { parse: Number }).parse)).toEqual([null, 100]);
  });
});
