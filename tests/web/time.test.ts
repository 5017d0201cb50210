import { frameAtFraction, frameCount, frameTicks, snapToFrame, stepFrames, type FrameRange } from "@/model/time";

const range: FrameRange = { start: 1, end: 96, framesPerSecond: 24 };
const still: FrameRange = { start: 0, end: 0, framesPerSecond: 24 };

describe("frames", () => {
  it("counts both ends", () => {
    expect(frameCount(range)).toBe(96);
    expect(frameCount(still)).toBe(1);
  });

  it("steps stop at the ends of the shot", () => {
    expect(stepFrames(range, 96, 1)).toBe(96);
    expect(stepFrames(range, 3, -10)).toBe(1);
    expect(stepFrames(range, 40, 10)).toBe(50);
  });

  it("a time between frames, or outside the shot, goes to the nearest frame", () => {
    expect(snapToFrame(range, 12.4)).toBe(12);
    expect(snapToFrame(range, -5)).toBe(1);
    expect(snapToFrame({ ...range, start: 0.5, end: 3.5 }, 2.2)).toBe(2.5);
  });

  it("the ends of the scrubber are the ends of the shot", () => {
    expect([frameAtFraction(range, 0), frameAtFraction(range, 1)]).toEqual([1, 96]);
  });
});

describe("frame labels", () => {
  it("are round, inside the shot, and not too many", () => {
    const ticks = frameTicks(range, 10);
    expect(ticks).toEqual([10, 20, 30, 40, 50, 60, 70, 80, 90]);
    expect(frameTicks(still, 10)).toEqual([0]);
  });

  it("never fall between frames", () => {
    expect(frameTicks({ start: 1, end: 4, framesPerSecond: 24 }, 40)).toEqual([1, 2, 3, 4]);
  });
});
