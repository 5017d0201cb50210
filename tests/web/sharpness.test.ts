import { gateWidthMm, readMap } from "@/model/focus_map";
import { formatCircle, formatOffset, holdingStop, judge, missed, sharpLimitMm, stopsToHold } from "@/model/sharpness";
import { formatStop } from "@/model/stops";
import { decodeFocusMap } from "@/net/focus_map";
import { FOCUS_MAP } from "./fake_service";
import { point } from "./points";

describe("a focus map", () => {
  it("is read as it was written", async () => {
    const map = await decodeFocusMap(FOCUS_MAP);
    expect([...map.cocPx]).toEqual([-1.5, 0.25, 0.5, 8]);
    expect([...map.depthM]).toEqual([1, 2, 2.5, Infinity]);
    expect(gateWidthMm(map)).toBeCloseTo(0.2);
  });

  it("has a diameter and a depth at each place, its edges included", async () => {
    const map = await decodeFocusMap(FOCUS_MAP);
    expect(readMap(map, [0.2, 0.2])).toEqual({ depthM: 1, cocMm: expect.closeTo(-0.3) as number });
    expect(readMap(map, [1, 1])).toEqual({ depthM: Infinity, cocMm: expect.closeTo(1.6) as number });
    expect(readMap(map, [0.49, 0.51]).depthM).toBe(2.5);
  });

  it("of a wrong size is refused", async () => {
    const head = new TextEncoder().encode('{"width":3,"height":2,"filmMmPerPx":0.1}');
    const body = new Uint8Array(FOCUS_MAP).slice(4 + new DataView(FOCUS_MAP).getUint32(0));
    const wrong = new Uint8Array([0, 0, 0, head.length, ...head, ...body]);
    await expect(decodeFocusMap(wrong.buffer)).rejects.toThrow("not of the size");
  });
});

describe("what is sharp", () => {
  it("is said by the film, or by pixels of the delivery", () => {
    expect(sharpLimitMm("film", 0.02, 24, 1920)).toBe(0.02);
    expect(sharpLimitMm("2", 0.02, 24, 1920)).toBeCloseTo(0.025);
    expect(sharpLimitMm("2", 0.02, 24, 3840)).toBeCloseTo(0.0125);
  });

  it("is held by closing the lens as many stops as the circle has too much", () => {
    expect(stopsToHold(-0.04, 0.02)).toBeCloseTo(2);
    expect(stopsToHold(0.01, 0.02)).toBeCloseTo(-2);
    expect(formatStop(holdingStop(2, 0.04, 0.02))).toBe("f/4");
    expect(formatStop(holdingStop(1.4, 0.5, 0.02))).toBe("f/36");
    // The next third on the ring, and no wider.
    expect(formatStop(holdingStop(2.8, 0.041, 0.02))).toBe("f/6.3");
    expect(["f/22", "f/1.2", "f/1.4"]).toEqual([22.6, 1.26, Math.SQRT2].map(formatStop));
  });

  it("is judged by the circle on the film", () => {
    expect(judge({ depthM: 3, cocMm: 0.03, focusDistanceM: 2.9 }, 0.02)).toEqual({
      isSharp: false,
      offsetM: expect.closeTo(0.1) as number,
      cocMm: 0.03,
    });
    expect(judge({ depthM: 3, cocMm: 0.03, focusDistanceM: Infinity }, 0.04)).toMatchObject({ isSharp: true });
    expect(judge({ depthM: -3, cocMm: null, focusDistanceM: null }, 0.02)).toBeNull();
    // An orthographic camera sees what is behind its origin, too.
    expect(judge({ depthM: -3, cocMm: 0.01, focusDistanceM: -3.5 }, 0.02)).toMatchObject({ isSharp: true });
  });

  it("is missed by points that count and are to be sharp", () => {
    const soft = { depthM: 3, cocMm: 0.03, focusDistanceM: 2.9 };
    const counts = { share: 0.5, sharpness: soft };
    const points = [
      { ...point("mara"), ...counts },
      { ...point("pip"), share: 0.5 },
      { ...point("lamp"), sharpness: soft },
      { ...point("veil", {}, { kind: "soft" }), ...counts },
      { ...point("off", {}, { enabled: false }), ...counts },
    ];
    expect(missed(points, 0.02).map(({ point: { name } }) => name)).toEqual(["mara"]);
    expect(missed(points, 0.05)).toEqual([]);
  });
});

describe("in words", () => {
  it("a distance from the focus has a sign", () => {
    expect(formatOffset(0.123, "m")).toBe("+12 cm");
    expect(formatOffset(-0.0123, "m")).toBe("−1.2 cm");
    expect(formatOffset(6.64, "m")).toBe("+6.64 m");
    expect(formatOffset(-Infinity, "m")).toBe("−∞");
    expect(formatOffset(-0.3048, "ft")).toBe("−1′ 0″");
  });

  it("a circle is in millimetres and in pixels of the delivery", () => {
    expect(formatCircle(-0.0375, 36, 1920)).toBe("0.037 mm, 2.0 px");
    expect(formatCircle(0.5625, 36, 1920)).toBe("0.56 mm, 30 px");
  });
});
