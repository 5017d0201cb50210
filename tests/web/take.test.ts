import type { Curve } from "@/model/curve";
import { errorOf } from "@/model/fit";
import type { Key } from "@/model/keys";
import { valueAt } from "@/model/spline";
import { endOf, keptNotes, notesOf, samplesOf, takeOf, type Take } from "@/model/take";
import { applyTake, simplify, type FocusBefore } from "@/model/take_edit";

const RANGE = { start: 1, end: 96, framesPerSecond: 24 };
const [TOLERANCE, FAR_M] = [0.02, 60];

function recorded(start: number, end: number, distanceAt: (time: number) => number): Take {
  const moments = Array.from({ length: 2 * (end - start) + 1 }, (_moment, at) => {
    const time = start + at / 2;
    return { time, distanceM: distanceAt(time) };
  });
  const take = takeOf(1, moments, RANGE.start);
  if (!take) throw new Error("There is no take.");
  return take;
}

describe("a take", () => {
  it("has the frames between its moments, even as the ring turns", () => {
    const moments = [
      { time: 10.4, distanceM: 1 },
      { time: 12.4, distanceM: Infinity },
      { time: 13.9, distanceM: Infinity },
    ];
    const take = takeOf(3, moments, 1);
    expect(take).toMatchObject({ number: 3, start: 11, nearness: [0.7, 0.2, 0] });
    expect(take && endOf(take)).toBe(13);
    expect(take && samplesOf(take).at(-1)).toEqual({ time: 13, distanceM: Infinity });
  });

  it("is none where no frame was", () => {
    expect(takeOf(1, [], 1)).toBeNull();
    expect(takeOf(1, [{ time: 3.2, distanceM: 1 }, { time: 3.7, distanceM: 2 }], 1)).toBeNull(); // prettier-ignore
  });

  it("is kept with the marks, and comes back", () => {
    const take = recorded(5, 20, (time) => 1 + time / 10);
    const notes = { marks: [2, null, Infinity], punchIn: 5, punchOut: null, takes: [take] };
    expect(notesOf(JSON.parse(JSON.stringify(keptNotes(notes))))).toEqual(notes);
  });

  it.each([null, "x", 3, { takes: 3, marks: {} }, { takes: [{ number: 1, start: 1, nearness: ["1"] }, null] }])(
    "that cannot be read (%j) is left out",
    (json) => {
      expect(notesOf(json)).toEqual({ marks: [], punchIn: null, punchOut: null, takes: [] });
    },
  );
});

/** Keys after changes. */
function after(keys: readonly Key[], changes: ReturnType<typeof applyTake>): readonly Key[] {
  return changes.reduce<readonly Key[]>((now, change) => {
    if (change.type === "setCamera") return [];
    if (change.type === "unkeySetting") return now.filter(({ time }) => time !== change.time);
    if (change.type !== "keySetting") return now;
    const others = now.filter(({ time }) => time !== change.key.time);
    return [...others, change.key as Key].toSorted((a, b) => a.time - b.time);
  }, keys);
}

function solved(distanceAt: (time: number) => number): Curve {
  return Array.from({ length: 96 }, (_frame, at) => ({
    time: at + 1,
    focusDistanceM: distanceAt(at + 1),
  })) as unknown as Curve;
}

const take = recorded(30, 60, (time) => 2 + (time - 30) / 15);
const simplified = simplify(take, TOLERANCE, FAR_M);

/** Largest error of the curve of keys from the take. */
function inTake(keys: readonly Key[]): number {
  return Math.max(
    ...samplesOf(take).map(({ time, distanceM }) => errorOf(valueAt(keys, time) ?? NaN, distanceM, FAR_M)),
  );
}

describe("a take that is applied", () => {
  it("is straight where it was, by two keys", () => {
    expect(simplified.keys).toHaveLength(2);
    expect(simplified.error).toBeLessThan(1e-4);
  });

  it("takes the focus from the points, which stays as it was before and after", () => {
    const curve = solved((time) => (time < 45 ? 3 : 6));
    const before: FocusBefore = { mode: "points", keys: [], curve, range: RANGE };
    const changes = applyTake(simplified, before, TOLERANCE, FAR_M);
    expect(changes[0]).toMatchObject({ type: "setFocus", values: { mode: "manual" } });
    const keys = after([], changes);
    expect(keys).toHaveLength(4);
    expect(inTake(keys)).toBeLessThan(TOLERANCE);
    expect([1, 29, 61, 96].map((time) => valueAt(keys, time))).toEqual([3, 3, 6, 6]);
  });

  it("goes among the keys of a focus by hand", () => {
    const own: Key[] = [
      { time: 1, value: 1, interpolation: "auto" },
      { time: 40, value: 5, interpolation: "auto" },
      { time: 80, value: 3, interpolation: "auto" },
    ];
    const before: FocusBefore = { mode: "manual", keys: own, curve: [], range: RANGE };
    const keys = after(own, applyTake(simplified, before, TOLERANCE, FAR_M));
    expect(inTake(keys)).toBeLessThan(TOLERANCE);
    for (const time of [1, 15, 29, 61, 70, 96]) expect(valueAt(keys, time)).toBeCloseTo(valueAt(own, time) ?? NaN, 4);
    expect(keys.map(({ time }) => time)).toEqual([1, 29, 30, 60, 61, 80]);
  });
});

describe("a take of a focus by hand", () => {
  it("leaves one that has no keys as it was outside", () => {
    const before: FocusBefore = { mode: "manual", keys: [], curve: solved(() => 4), range: RANGE };
    const changes = applyTake(
      simplify(
        recorded(30, 60, () => 2),
        TOLERANCE,
        FAR_M,
      ),
      before,
      TOLERANCE,
      FAR_M,
    );
    expect(changes.some(({ type }) => type === "setFocus")).toBe(false);
    const keys = after([], changes);
    expect([1, 29, 30, 60, 61, 96].map((time) => valueAt(keys, time))).toEqual([4, 4, 2, 2, 4, 4]);
  });

  it("of the whole shot leaves no other keys", () => {
    const all = simplify(
      recorded(1, 96, (time) => 1 + time / 50),
      TOLERANCE,
      FAR_M,
    );
    const own: Key[] = Array.from({ length: 96 }, (_key, at) => ({ time: at + 1, value: 2, interpolation: "auto" }));
    const before: FocusBefore = { mode: "manual", keys: own, curve: solved(() => 2), range: RANGE };
    expect(after(own, applyTake(all, before, TOLERANCE, FAR_M))).toHaveLength(2);
  });
});

function auto(time: number, value: number): Key {
  return { time, value, interpolation: "auto" };
}

describe("the focus outside a take of a focus by hand", () => {
  const straight = (time: number, value: number): Key => ({ time, value, interpolation: "linear" });
  it.each<[string, readonly Key[]]>([
    ["with a key on the frame before it", [auto(10, 2), auto(24, 4), auto(30, 7), auto(40, 6), auto(50, 3)]],
    ["with a key on the frame after it", [auto(10, 2), auto(20, 4), auto(30, 7), auto(36, 6), auto(50, 3)]],
    ["with keys on both", [auto(10, 2), auto(24, 4), auto(30, 7), auto(36, 6), auto(50, 3)]],
    ["with a straight segment under it", [straight(10, 2), auto(40, 5), auto(60, 9)]],
    [
      "with a straight segment under it that a held key leads to",
      [{ ...auto(1, 2), interpolation: "held" }, straight(24, 2), auto(40, 5), auto(60, 9)],
    ],
    [
      "with handles of no length",
      [
        auto(10, 2),
        { ...auto(24, 4), interpolation: "bezier", tangents: { inSlope: 0.5, outSlope: 0.1 } },
        auto(30, 7),
        auto(50, 3),
      ],
    ],
    [
      "with no key after it",
      [
        auto(5, 2),
        { ...auto(15, 4), interpolation: "bezier", tangents: { inSlope: 0.3, inWidth: 3, outSlope: 0.3, outWidth: 3 } },
      ],
    ],
    ["with no key beside it", [auto(40, 2), auto(60, 5), auto(70, 9)]],
  ])("stays as it was, %s", (_name, own) => {
    const pull = simplify(
      recorded(25, 35, (time) => 1 + (time - 25) / 20),
      TOLERANCE,
      FAR_M,
    );
    const before: FocusBefore = { mode: "manual", keys: own, curve: [], range: RANGE };
    const keys = after(own, applyTake(pull, before, TOLERANCE, FAR_M));
    for (let time = 1; time <= 96; time += 0.25) {
      if (time > 24 && time < 36) continue;
      expect(valueAt(keys, time)).toBeCloseTo(valueAt(own, time) ?? NaN, 4);
    }
    expect(keys.filter(({ time }) => time > 24 && time < 36).map(({ time }) => time)).toEqual([25, 35]);
  });
});

it("a take leaves alone keys whose curve stays by itself", () => {
  const own = [auto(5, 1), auto(10, 2), auto(40, 3), auto(60, 5), auto(70, 9), auto(90, 2)];
  const before: FocusBefore = { mode: "manual", keys: own, curve: [], range: RANGE };
  const pull = simplify(take, TOLERANCE, FAR_M);
  const keys = after(own, applyTake(pull, before, TOLERANCE, FAR_M));
  expect(own.filter((key) => keys.includes(key)).map(({ time }) => time)).toEqual([5, 90]);
});
