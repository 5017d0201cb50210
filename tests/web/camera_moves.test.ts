import { moveCamera, moved, pivotOf, poseOf, rollOf, type CameraPose, type HeldCamera } from "@/model/camera_moves";
import { dot, type Vector } from "@/model/vector";

const LEVEL: CameraPose = { positionM: [0, 1, 4], ahead: [0, 0, -1], up: [0, 1, 0] };
const HELD: HeldCamera = { pose: LEVEL, pivotM: [0, 1, 0], widthPerM: 0.5, aspect: 2 };

function minus(a: Vector, b: Vector): Vector {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

function expectVector(actual: Vector, wanted: Vector): void {
  for (const axis of [0, 1, 2] as const) expect(actual[axis]).toBeCloseTo(wanted[axis], 9);
}

describe("an orbit", () => {
  it("goes around the pivot by half a turn over the picture's width", () => {
    const { pose } = moved(HELD, "orbit", [0.5, 0]);
    expectVector(pose.positionM, [-4, 1, 0]);
    expectVector(pose.ahead, [1, 0, 0]);
    expectVector(pose.up, [0, 1, 0]);
  });

  it("rises as the pointer goes down", () => {
    const { pose } = moved(HELD, "orbit", [0, 0.25]);
    expectVector(pose.positionM, [0, 1 + 4 * Math.SQRT1_2, 4 * Math.SQRT1_2]);
    expectVector(pose.ahead, [0, -Math.SQRT1_2, -Math.SQRT1_2]);
  });

  it("keeps the distance to a pivot beside the axis, where that is in the picture, and the roll", () => {
    const held = { ...HELD, pivotM: [0.4, 1.3, 1] as const };
    const place = ({ positionM, ahead, up }: CameraPose): number[] => {
      const way = minus(held.pivotM, positionM);
      return [Math.hypot(...way), dot(way, ahead), dot(way, up)];
    };
    for (const by of [
      [0.3, 0.2],
      [-1.7, -0.4],
      [4, 0.1],
    ] as const) {
      // prettier-ignore
      const { pose } = moved(held, "orbit", by);
      place(pose).forEach((value, at) => { expect(value).toBeCloseTo(place(held.pose)[at] ?? NaN, 9); }); // prettier-ignore
      expect(rollOf(pose)).toBeCloseTo(0, 9);
      expect([Math.hypot(...pose.ahead), Math.hypot(...pose.up), dot(pose.ahead, pose.up)]).toEqual([
        expect.closeTo(1, 9),
        expect.closeTo(1, 9),
        expect.closeTo(0, 9),
      ]);
    }
  });
});

describe("a steep or rolled camera", () => {
  it("stops short of the vertical", () => {
    const { pose } = moved(HELD, "orbit", [0, 3]);
    expect((Math.asin(pose.ahead[1]) / Math.PI) * 180).toBeCloseTo(-89.5, 6);
    expect(pose.up[1]).toBeGreaterThan(0);
  });

  it("keeps the roll of a rolled camera", () => {
    const roll = 0.3;
    const rolled = { ...LEVEL, up: [Math.sin(roll), Math.cos(roll), 0] as const };
    const { pose } = moved({ ...HELD, pose: rolled }, "orbit", [0.3, 0.2]);
    expect(Math.abs(rollOf(rolled))).toBeCloseTo(roll, 9);
    expect(rollOf(pose)).toBeCloseTo(rollOf(rolled), 9);
  });

  it("turns a camera that looks straight down", () => {
    const down: CameraPose = { positionM: [0, 4, 0], ahead: [0, -1, 0], up: [0, 0, -1] };
    const { pose } = moved({ ...HELD, pose: down, pivotM: [0, 0, 0] }, "orbit", [0.5, -0.25]);
    expect(Math.hypot(...pose.positionM)).toBeCloseTo(4, 9);
    expectVector(pose.positionM, [-4 * Math.SQRT1_2, 4 * Math.SQRT1_2, 0]);
  });
});

describe("a pan", () => {
  it("keeps what is as deep as the pivot at the pointer, and the direction", () => {
    const { pose } = moved(HELD, "pan", [0.25, 0.5]);
    expectVector(pose.positionM, [-0.5, 1.5, 4]); // the picture is 2 m by 1 m there
    expect([pose.ahead, pose.up]).toEqual([LEVEL.ahead, LEVEL.up]);
  });
});

describe("a dolly", () => {
  it("halves the distance along the axis by half a picture, and doubles it back", () => {
    expectVector(moved(HELD, "dolly", [0.5, 0]).pose.positionM, [0, 1, 2]);
    expectVector(moved(HELD, "dolly", [0, -0.5]).pose.positionM, [0, 1, 2]);
    expectVector(moved(HELD, "dolly", [0, 0.5]).pose.positionM, [0, 1, 8]);
  });

  it("does not go through the pivot", () => {
    expectVector(moved(HELD, "dolly", [100, 0]).pose.positionM, [0, 1, 0.01]);
  });
});

describe("the pivot", () => {
  it("is the selected point before the camera, else the focus", () => {
    expect(pivotOf(LEVEL, [1, 2, 3], 2)).toEqual([1, 2, 3]);
    expect(pivotOf(LEVEL, [0, 1, 5], 2)).toEqual([0, 1, 2]);
    expect(pivotOf(LEVEL, null, 3)).toEqual([0, 1, 1]);
  });

  it("is 5 m away where the focus is infinite", () => {
    expect(pivotOf(LEVEL, null, Infinity)).toEqual([0, 1, -1]);
  });
});

it("takes a camera from the set from above and puts it there by a change", () => {
  const pose = poseOf({ positionM: [0, 1, 4], right: [1, 0, 0], ahead: [0, 0, -1] });
  expectVector(pose.up, [0, 1, 0]);
  expect(moveCamera(LEVEL, 24, true)).toEqual({ type: "moveCamera", ...LEVEL, time: 24, keyed: true });
});
