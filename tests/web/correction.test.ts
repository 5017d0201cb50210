import { correct, isDense, recorrect } from "@/model/correction";
import type { Changes } from "@/model/changes";
import { MOST_CHANGES } from "@/model/key_lanes";
import type { Key, KeyedSetting } from "@/model/keys";
import { valueAt } from "@/model/spline";

/** Keys on every frame from 1 to 96. */
function dense(valueOf: (time: number) => number, more: Partial<Key> = {}): Key[] {
  return Array.from({ length: 96 }, (_, i) => ({
    time: i + 1,
    value: valueOf(i + 1),
    interpolation: "linear",
    ...more,
  }));
}

function after(keys: readonly Key[], changes: Changes): Key[] {
  const set = changes.flatMap((change) => (change.type === "keySetting" ? [change.key as Key] : []));
  const times = new Set(set.map(({ time }) => time));
  return [...keys.filter(({ time }) => !times.has(time)), ...set].toSorted((a, b) => a.time - b.time);
}

const DISTANCE: KeyedSetting = "focusDistanceM";

it("a curve is dense where keys are close on both sides", () => {
  const keys = dense(() => 3);
  expect([isDense(keys, 40), isDense(keys, 40.5), isDense(keys, 1), isDense(keys, 96)]).toEqual([
    true,
    true,
    true,
    true,
  ]);
  expect(isDense(keys.slice(38, 40), 40)).toBe(false);
  expect(
    isDense(
      [keys[0], keys[39], keys[95]].filter((key) => key !== undefined),
      40,
    ),
  ).toBe(false);
  expect(isDense([], 4)).toBe(false);
});

describe("a correction", () => {
  it("has the value where it is wanted, no spike, and leaves what is far as it was", () => {
    const keys = dense((time) => 2 + time / 50);
    const bent = after(keys, correct({ owner: { setting: DISTANCE }, keys, time: 40, value: 4 }, 12));
    expect(valueAt(bent, 40)).toBe(4);
    expect(bent.filter((key, i) => key.value !== keys[i]?.value).map(({ time }) => time)).toEqual(
      Array.from({ length: 23 }, (_, i) => 29 + i),
    );
    const steps = bent.slice(1).map((key, i) => Math.abs(1 / key.value - 1 / (bent[i]?.value ?? 1)));
    expect(Math.max(...steps)).toBeLessThan(0.2 * Math.abs(1 / 4 - 1 / 2.8));
  });
});

describe("the size of a correction", () => {
  it("of an f-number is in stops, and of an angle in degrees", () => {
    const keys = dense(() => 4);
    const bent = after(keys, correct({ owner: { setting: "fStop" }, keys, time: 40, value: 8 }, 10));
    expect(valueAt(bent, 45)).toBeCloseTo(4 * 2 ** (0.75 ** 2));
    expect([valueAt(bent, 30), valueAt(bent, 50)]).toEqual([4, 4]);
    const tilted = after(keys, correct({ owner: { setting: "tiltDeg" }, keys, time: 40, value: -1 }, 10));
    expect(valueAt(tilted, 45)).toBeCloseTo(4 - 5 * 0.75 ** 2);
  });

  it("beside a jump stays above 0", () => {
    const keys = dense((time) => (time < 25 ? 2.8 : 16));
    const bent = after(keys, correct({ owner: { setting: "fStop" }, keys, time: 26, value: 2.8 }, 12));
    expect(Math.min(...bent.map(({ value }) => value))).toBeGreaterThan(0.4);
  });
});

describe("a correction that is sent", () => {
  it("of very many keys bends as many as an edit takes", () => {
    const halves = dense(() => 4).flatMap((key) => [key, { ...key, time: key.time + 0.5 }]);
    const changes = recorrect({ owner: { setting: "fStop" }, keys: halves, time: 40, value: 5 }, 100, 90);
    expect(changes.length).toBeGreaterThan(100);
    expect(changes.length).toBeLessThanOrEqual(MOST_CHANGES);
  });

  it("that is made again less widely sets what is beyond back", () => {
    const keys = dense((time) => 2 + time / 50);
    const correction = { owner: { setting: DISTANCE }, keys, time: 40, value: 4 };
    const wide = after(keys, correct(correction, 12));
    expect(after(wide, recorrect(correction, 12, 5))).toEqual(after(keys, correct(correction, 5)));
    expect(after(wide, recorrect(correction, 12, 20))).toEqual(after(keys, correct(correction, 20)));
  });

  it("turns handles with the curve", () => {
    const flat = { inSlope: 0, inWidth: 1 / 3, outSlope: 0, outWidth: 1 / 3 };
    for (const setting of [DISTANCE, "fStop"] as const) {
      const keys = dense(() => 4, { interpolation: "bezier", tangents: flat });
      const bent = after(keys, correct({ owner: { setting }, keys, time: 40, value: 5 }, 10));
      const [at34, key, at36] = [bent[33], bent[34], bent[35]];
      const slope = ((at36?.value ?? 0) - (at34?.value ?? 0)) / 2;
      expect(key?.tangents?.outSlope).toBeCloseTo(slope, 2);
      expect(key?.tangents?.inSlope).toBe(key?.tangents?.outSlope);
    }
  });

  it("between two keys adds one", () => {
    const keys = dense(() => 4);
    const bent = after(keys, correct({ owner: { setting: "fStop" }, keys, time: 40.5, value: 8 }, 3));
    expect(valueAt(bent, 40.5)).toBe(8);
    expect(bent).toHaveLength(97);
  });

  it("to infinity goes as far as a curve can", () => {
    const keys = dense(() => 4);
    const bent = after(keys, correct({ owner: { setting: DISTANCE }, keys, time: 40, value: Infinity }, 6));
    expect(valueAt(bent, 40)).toBe(100_000);
    expect(bent.every(({ value }) => value > 0 && Number.isFinite(value))).toBe(true);
  });
});

it("a correction stays within what the attribute may be", () => {
  const owner = { point: "pip", attribute: "weight" } as const;
  const keys = dense((time) => Math.max(0, 1 - time / 40), { interpolation: "bezier", tangents: { inSlope: -1 / 40 } });
  const bent = correct({ owner, keys, time: 36, value: 0 }, 12).flatMap((change) =>
    "key" in change ? [change.key] : [],
  );
  expect(Math.min(...bent.map(({ value }) => value))).toBe(0);
  expect(bent.find(({ time }) => time === 44)).toMatchObject({ value: 0, tangents: { inSlope: 0, outSlope: 0 } });
});
