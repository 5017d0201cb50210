import { frameDue, PlayMeter, shuttled, type Playing, type Repeat } from "@/model/playback";
import type { FrameRange } from "@/model/time";

const SHOT: FrameRange = { start: 1, end: 96, framesPerSecond: 24 };
const PART: FrameRange = { start: 10, end: 13, framesPerSecond: 24 };
const FORWARD: Playing = { range: SHOT, repeat: "loop", speed: 1, every: 1 };

/** The frames that are due one after the other. */
function played(playing: Playing, from: number, count: number): number[] {
  const { framesPerSecond } = playing.range;
  return Array.from({ length: count }, (_, k) => frameDue(playing, from, k / framesPerSecond).time);
}

describe("the frame that is due", () => {
  it("is true to the clock, however few frames are shown", () => {
    expect(frameDue(FORWARD, 1, 1).time).toBe(25);
    expect(frameDue(FORWARD, 10, 0.5).time).toBe(22);
  });

  it.each<[Repeat, number[]]>([
    ["loop", [12, 13, 10, 11, 12, 13, 10, 11]],
    ["pingPong", [12, 13, 12, 11, 10, 11, 12, 13]],
    ["once", [12, 13, 13, 13, 13, 13, 13, 13]],
  ])("after the last one follows what is chosen: %s", (repeat, expected) => {
    expect(played({ ...FORWARD, range: PART, repeat }, 12, 8)).toEqual(expected);
  });

  it("goes backwards, and repeats there too", () => {
    expect(played({ ...FORWARD, range: PART, speed: -1 }, 11, 4)).toEqual([11, 10, 13, 12]);
    expect(played({ ...FORWARD, range: PART, speed: -1, repeat: "pingPong" }, 11, 4)).toEqual([11, 10, 11, 12]);
  });

  it("is the last one where nothing follows, either way", () => {
    const once: Playing = { ...FORWARD, range: PART, repeat: "once" };
    expect([0, 1, 2, 3].map((k) => frameDue(once, 11, k / 24).isLast)).toEqual([false, false, true, true]);
    expect(frameDue({ ...once, speed: -2 }, 13, 2 / 24)).toMatchObject({ time: 10, isLast: true });
    expect(frameDue({ ...once, repeat: "loop" }, 11, 10).isLast).toBe(false);
  });

  it("is every second or third one, from the first on", () => {
    expect(played({ ...FORWARD, range: PART, every: 2 }, 10, 5)).toEqual([10, 10, 12, 12, 10]);
    expect(frameDue({ ...FORWARD, every: 3 }, 1, 6 / 24).index).toBe(2);
  });

  it("of a range that they do not divide begins anew with the first, and none of them is missing", () => {
    const five: Playing = { ...FORWARD, range: { ...PART, end: 14 }, every: 2 };
    expect(played(five, 10, 8)).toEqual([10, 10, 12, 12, 14, 14, 10, 10]);
    expect(frameDue(five, 10, 7 / 24).index).toBe(3);
  });

  it("of a shot of one frame is that frame", () => {
    const still: FrameRange = { start: 0, end: 0, framesPerSecond: 24 };
    for (const repeat of ["loop", "pingPong", "once"] as const)
      expect(frameDue({ ...FORWARD, range: still, repeat }, 0, 12.3).time).toBe(0);
  });

  it("of a start outside the range is the nearest one at first", () => {
    expect(frameDue({ ...FORWARD, range: PART }, 90, 0).time).toBe(13);
  });
});

describe("the shuttle", () => {
  it("goes twice as fast with each push, and turns round at once", () => {
    const pushed = [1, 1, 1, 1, 1].reduce<number[]>((speeds) => [...speeds, shuttled(speeds.at(-1) ?? 0, 1)], []);
    expect(pushed).toEqual([1, 2, 4, 8, 8]);
    expect(shuttled(4, -1)).toBe(-1);
    expect(shuttled(-2, -1)).toBe(-4);
  });
});

describe("the meter", () => {
  const due = (index: number) => ({ time: 1 + index, index, isLast: false });

  it("says the rate of what is shown, and how many were due and were not", () => {
    const meter = new PlayMeter();
    for (const index of [0, 1, 4]) meter.ask(due(index));
    expect(meter.show(1, 1000)).toEqual({ rate: null, dropped: 0 });
    expect(meter.show(2, 1040)).toEqual({ rate: 25, dropped: 0 });
    expect(meter.show(5, 1160)).toEqual({ rate: 12.5, dropped: 2 });
  });

  it("counts what was asked for and came too late as dropped", () => {
    const meter = new PlayMeter();
    for (const index of [0, 1, 2]) meter.ask(due(index));
    expect(meter.show(3, 1000)).toMatchObject({ dropped: 2 });
    expect(meter.show(2, 1010)).toBeNull();
  });

  it("counts a frame that comes round again", () => {
    const meter = new PlayMeter();
    for (const index of [0, 1, 2, 3]) meter.ask({ time: 1 + (index % 2), index, isLast: false });
    for (const [k, time] of [1, 2, 1, 2].entries()) expect(meter.show(time, 40 * k)?.dropped).toBe(0);
  });

  it("says so where no picture comes any more", () => {
    const meter = new PlayMeter();
    for (const index of [0, 1]) meter.ask(due(index));
    meter.show(1, 0);
    meter.show(2, 40);
    expect(meter.late(due(2), 80)).toBeNull();
    expect(meter.late(due(24), 1000)).toEqual({ rate: 1, dropped: 22 });
    expect(meter.late(due(72), 3000)).toEqual({ rate: 0, dropped: 70 });
  });

  it("forgets what is long past in the rate", () => {
    const meter = new PlayMeter();
    for (let index = 0; index < 100; index += 1) meter.ask(due(index));
    for (let index = 0; index < 10; index += 1) meter.show(1 + index, 1000 * index);
    expect(meter.show(11, 9040)?.rate).toBeGreaterThan(1);
  });
});
