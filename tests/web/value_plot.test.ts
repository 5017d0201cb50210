import { handlePlace, type Plot } from "@/view/timeline/value_plot";

const plot = { x: (time: number) => 10 * time, y: (value: number) => 100 - value } as Plot;
const key = { time: 4, value: 50 };

describe("the end of a handle is shown", () => {
  it("where it is", () => {
    expect(handlePlace(plot, key, { time: 8, value: 60 }, "out")).toEqual({ x: 80, y: 40 });
  });

  it("in its direction, away from the key, where it is short", () => {
    expect(handlePlace(plot, key, { time: 4.3, value: 46 }, "out")).toEqual({ x: 40 + 26 * 0.6, y: 50 + 26 * 0.8 });
    expect(handlePlace(plot, key, { time: 3, value: 50 }, "in")).toEqual({ x: 14, y: 50 });
  });

  it("beside the key, where it has no length", () => {
    expect(handlePlace(plot, key, key, "in")).toEqual({ x: 14, y: 50 });
    expect(handlePlace(plot, key, key, "out")).toEqual({ x: 66, y: 50 });
  });
});
