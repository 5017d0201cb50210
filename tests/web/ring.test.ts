import { formatMark } from "@/model/distance";
import { distanceAt, drawnTo, engravings, fromPupil, ringOf, saidFrom, turnAt, type Ring } from "@/model/ring";
import type { Readout } from "@/model/shot";

/** A thin lens of 50 mm that focuses down to 0.55 m from its pupil. */
const RING: Ring = { closeM: 0.55, toFilmM: [0.05, 0.055] };

describe("the focus ring", () => {
  it("turns from close focus to infinity as the lens moves", () => {
    expect([0.55, 1.1, Infinity].map((distanceM) => turnAt(RING, distanceM))).toEqual([0, 0.5, 1]);
    for (const turn of [0, 0.3, 0.9]) expect(turnAt(RING, distanceAt(RING, turn))).toBeCloseTo(turn, 12);
    expect(distanceAt(RING, 1)).toBe(Infinity);
  });

  it("goes no farther than its ends", () => {
    expect([turnAt(RING, 0.2), turnAt(RING, -5)]).toEqual([0, 1]);
    expect([distanceAt(RING, -0.5), distanceAt(RING, 1.5)]).toEqual([0.55, Infinity]);
  });

  it("is that of the lens, where the lens can be turned", () => {
    const readout = { closeFocusM: 0.55, pupilToFilmMm: [50, 55] } as unknown as Readout;
    expect(ringOf(readout)).toEqual(RING);
    expect(ringOf({ ...readout, closeFocusM: 1e9 })).toBeNull();
  });

  it("has distances from the film, as makers engrave them, or from the entrance pupil", () => {
    expect(saidFrom("film", RING, 0.55)).toBeCloseTo(0.605, 12); // 0.55 + 1/(1/0.05 - 1/0.55)
    expect(saidFrom("pupil", RING, 0.55)).toBe(0.55);
    expect(saidFrom("film", RING, Infinity)).toBe(Infinity);
    for (const distanceM of [0.55, 2, 30]) {
      expect(fromPupil("film", RING, saidFrom("film", RING, distanceM))).toBeCloseTo(distanceM, 12);
    }
    expect(fromPupil("film", RING, 0.05)).toBeNaN();
  });

  it.each([
    ["m", "film"],
    ["m", "pupil"],
    ["ft", "film"],
  ] as const)("is engraved in %s from the %s, with round numbers that have room", (unit, origin) => {
    const scale = engravings(RING, unit, origin);
    const named = scale.filter(({ isNamed }) => isNamed);
    expect(scale.at(-1)).toMatchObject({ turn: 1, distanceM: Infinity, isNamed: true });
    expect(named.length).toBeGreaterThan(8);
    for (const [at, { turn, distanceM }] of named.entries()) {
      expect(turn).toBeCloseTo(turnAt(RING, fromPupil(origin, RING, distanceM)), 9);
      expect(turn - (named[at - 1]?.turn ?? -1)).toBeGreaterThan(0.03);
      expect(formatMark(distanceM, unit).length).toBeLessThan(7);
    }
  });
});

describe("a mark that draws the ring", () => {
  it("holds it there, and lets it go without a jump", () => {
    expect(drawnTo([0.5], 0.5)).toBe(0.5);
    expect(drawnTo([0.5], 0.504)).toBeLessThan(0.501);
    expect(drawnTo([0.5], 0.512)).toBe(0.512);
    expect(drawnTo([0.5], 0.5119)).toBeCloseTo(0.5119, 3);
    expect(drawnTo([], 0.3)).toBe(0.3);
  });

  it("never turns it back", () => {
    const turns = Array.from({ length: 101 }, (_turn, at) => drawnTo([0.45, 0.5], 0.4 + at / 500));
    expect(turns).toEqual(turns.toSorted((a, b) => a - b));
  });
});
