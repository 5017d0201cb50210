import { guideFrames, guideIn, nextGuides, nextMask, SAFE, shareOf, smallest, WHOLE } from "@/model/guides";

const SHAPES = [
  { name: "2.39:1", aspect: 2.39 },
  { name: "1.85:1", aspect: 1.85 },
  { name: "1:1", aspect: 1 },
];

describe("framing guides", () => {
  it("are as large as fits, in the middle", () => {
    const scope = guideIn(16 / 9, 2.39);
    expect(scope.left).toBe(0);
    expect(scope.width).toBe(1);
    expect(scope.height).toBeCloseTo(16 / 9 / 2.39);
    expect(scope.top).toBeCloseTo((1 - scope.height) / 2);
    expect(guideIn(16 / 9, 1)).toMatchObject({ top: 0, height: 1, width: 9 / 16 });
  });

  it("come in the order of the shapes, however they were chosen", () => {
    const frames = guideFrames(1.5, SHAPES, ["1:1", "2.39:1", "7:1"]);
    expect(frames.map(({ name }) => name)).toEqual(["2.39:1", "1:1"]);
    expect(frames[1]?.box.width).toBeCloseTo(1 / 1.5);
  });

  it("have a smallest one, which the mask is around", () => {
    expect(smallest([])).toBeNull();
    expect(smallest(guideFrames(1.5, SHAPES, ["1:1", "1.85:1", "2.39:1"]))?.name).toBe("2.39:1"); // 0.63, 0.81 and 0.67
    expect(smallest(guideFrames(1.78, SHAPES, ["1:1", "2.39:1"]))?.name).toBe("1:1");
  });

  it("are gone through one by one, and none comes after several", () => {
    const steps = [["2.39:1"], ["1.85:1"], ["1:1"], []];
    let chosen: readonly string[] = [];
    for (const step of steps) {
      chosen = nextGuides(chosen, SHAPES);
      expect(chosen).toEqual(step);
    }
    expect(nextGuides(["2.39:1", "1:1"], SHAPES)).toEqual([]);
  });

  it("have safe areas of 93 and 90 % of both sides", () => {
    const action = shareOf(WHOLE, SAFE.action);
    expect([action.left, action.top, action.width, action.height]).toEqual(
      [0.035, 0.035, 0.93, 0.93].map((share) => expect.closeTo(share) as number),
    );
    const title = shareOf({ left: 0.2, top: 0, width: 0.6, height: 1 }, SAFE.title);
    expect(title.left).toBeCloseTo(0.23);
    expect(title.top).toBeCloseTo(0.05);
    expect(title.width).toBeCloseTo(0.54);
    expect(title.height).toBeCloseTo(0.9);
  });

  it("have a mask that gets darker step by step", () => {
    expect([0, 45, 60, 75, 100].map(nextMask)).toEqual([45, 75, 75, 100, 0]);
  });
});
