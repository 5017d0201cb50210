import { spread } from "@/view/plan/CutLabels";

describe("labels of the limits of sharpness", () => {
  it("stay where they are without names beside them, a line apart", () => {
    expect(
      spread(
        [
          [100, 40],
          [110, 45],
          [120, 90],
        ],
        [{ left: 0, right: 60, y: 42 }],
        300,
      ),
    ).toEqual([
      [100, 40],
      [110, 55],
      [120, 90],
    ]);
  });

  it("go to the right of the names that they would cover, with those close by", () => {
    const tags = [
      { left: 155, right: 200, y: 44 },
      { left: 80, right: 150, y: 48 },
    ];
    const labels = [
      [100, 40],
      [104, 62],
      [120, 120],
    ] as const;
    const places = [
      [206, 40],
      [210, 62],
      [120, 120],
    ];
    expect(spread(labels, tags, 300)).toEqual(places);
  });

  it("are left out where there is no room on the right", () => {
    expect(spread([[100, 40]], [{ left: 80, right: 290, y: 40 }], 230)).toEqual([null]);
  });
});
