import { draftQuality, letterbox, restQuality } from "@/model/quality";

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
      supersample: 0,
      format: "png",
    });
    const large = restQuality(3840, 2160);
    expect([large.width, large.height]).toEqual([1920, 1080]);
  });

  it("where pictures are not live a draft is a fraction of the work, and still a picture", () => {
    const rest = restQuality(960, 540);
    const draft = draftQuality(rest);
    expect(draft.width * draft.height * draft.rays).toBeLessThan(0.1 * rest.width * rest.height * rest.rays);
    expect(draft.width / draft.height).toBeCloseTo(rest.width / rest.height, 1);
    const least = draftQuality(restQuality(1, 1));
    expect(Math.min(least.width, least.height)).toBeGreaterThanOrEqual(16);
  });
});
