import { parseQuantity, trim } from "@/view/numbers";

describe("numbers as the panels have them", () => {
  it.each([
    ["0.2 s", "s", 0.2],
    ["0,2", "s", 0.2],
    ["12°", "°", 12],
    ["−3.5 °", "°", -3.5],
    ["60 %", "%", 60],
    ["2", "", 2],
  ])("%j is read", (text, unit, value) => {
    expect(parseQuantity(text, unit)).toBe(value);
  });

  it.each(["", "s", "fast", "1e999", "2 mm"])("%j is no number of seconds", (text) => {
    expect(parseQuantity(text, "s")).toBeNull();
  });

  it("has no digits that say nothing, nor a sign before nothing", () => {
    expect([trim(0.25, 2), trim(3, 1), trim(-0.001, 1)]).toEqual(["0.25", "3", "0"]);
  });
});
