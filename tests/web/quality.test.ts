import { FIRST_RUNG, letterbox, movingQuality, nextRung, restQuality } from "@/model/quality";

describe("letterbox", () => {
  it("fills a wide box in height, a tall one in width, centred", () => {
    expect(letterbox(1000, 300, 2)).toEqual({
      left: 200,
      top: 0,
      width: 600,
      height: 300,
    });
    expect(letterbox(320, 500, 2)).toEqual({
      left: 0,
      top: 170,
      width: 320,
      height: 160,
    });
  });
});

describe("quality", () => {
  it("at rest it is the size on screen, up to a bound, and as good as the command line's", () => {
    expect(restQuality(960, 540)).toMatchObject({
      width: 960,
      height: 540,
      rays: 100,
      layers: 4,
      supersample: 2,
      format: "png",
    });
    const large = restQuality(3840, 2160);
    expect([large.width, large.height]).toEqual([1920, 1080]);
  });

  it("while moving each rung is less work than the one before, and the last is still a picture", () => {
    const rest = restQuality(960, 540);
    const work = [0, 1, 2, 3, 4].map((rung) => {
      const { width, height, rays } = movingQuality(rest, rung);
      expect(Math.min(width, height)).toBeGreaterThanOrEqual(16);
      return width * height * rays;
    });
    expect(work).toEqual(work.toSorted((a, b) => b - a));
    expect(new Set(work).size).toBe(5);
  });

  it("goes down when the service is slow, up when it is quick, and rests between", () => {
    expect(nextRung(FIRST_RUNG, 900)).toBeGreaterThan(FIRST_RUNG);
    expect(nextRung(FIRST_RUNG, 20)).toBeLessThan(FIRST_RUNG);
    expect(nextRung(FIRST_RUNG, 150)).toBe(FIRST_RUNG);
    expect(nextRung(nextRung(4, 900), 900)).toBe(4);
    expect(nextRung(0, 1)).toBe(0);
  });
});
