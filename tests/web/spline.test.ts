import { readFileSync } from "node:fs";
import type { Key } from "@/model/keys";
import { curveOf, handleAt, insertion, tangentsAt, valueAt } from "@/model/spline";

interface Case {
  readonly name: string;
  readonly keys: readonly Key[];
  readonly values: readonly (readonly [time: number, value: number])[];
}

/** Written by `tests/usd_schemas/spline_cases.py`. */
const CASES = JSON.parse(readFileSync(new URL("splines.json", import.meta.url), "utf8")) as readonly Case[];

describe.each(CASES)("a spline with $name", ({ keys, values }) => {
  it("has the values of USD", () => {
    for (const [time, value] of values) expect(valueAt(keys, time), `at ${time.toString()}`).toBeCloseTo(value, 5);
  });

  it("stays as it is with one more key", () => {
    const [first, last] = [keys[0]?.time ?? 0, keys.at(-1)?.time ?? 0];
    const time = first + 0.37 * (last - first);
    const set = insertion(keys, time);
    const times = set.map((key) => key.time);
    const more = [...keys.filter((key) => !times.includes(key.time)), ...set].toSorted((a, b) => a.time - b.time);
    expect(more).toHaveLength(keys.length + (last > first ? 1 : 0));
    if (keys.some((key, i) => key.interpolation === "linear" && keys[i - 1]?.interpolation === "bezier")) return; // its handle is USD's
    for (const [at, value] of values) expect(valueAt(more, at), `at ${at.toString()}`).toBeCloseTo(value, 4);
  });

  it("is drawn where it is", () => {
    for (const { time, value } of curveOf(keys, 12)) {
      const at = keys.findIndex((key) => key.time === time);
      if (at < 0) expect(valueAt(keys, time)).toBeCloseTo(value, 5);
    }
  });
});

it("no keys have no value", () => {
  expect([valueAt([], 3), curveOf([], 4)]).toEqual([null, []]);
});

it("a key has a handle on the sides where the curve is curved", () => {
  const keys: Key[] = [
    { time: 0, value: 1, interpolation: "linear" },
    { time: 6, value: 2, interpolation: "auto" },
    { time: 12, value: 3, interpolation: "held" },
  ];
  expect(handleAt(keys, 0, "out")).toBeNull();
  expect(handleAt(keys, 1, "in")).toBeNull();
  expect(handleAt(keys, 1, "out")).toEqual({ time: 8, value: 2 + 2 * tangentsAt(keys, 1).outSlope });
  expect(handleAt(keys, 2, "in")).toBeNull();
  expect(handleAt(keys, 2, "out")).toBeNull();
});
