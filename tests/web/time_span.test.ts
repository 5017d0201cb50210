import { Playhead } from "@/editor/playhead";
import { TimeView } from "@/editor/time_view";
import { containing, framing, panned, wholeOf, zoomed } from "@/model/time_span";
import { timeAxis } from "@/view/timeline/time_axis";

const RANGE = { start: 1, end: 97, framesPerSecond: 24 };
const WHOLE = wholeOf(RANGE);

describe("a part of the shot", () => {
  it("is zoomed about a time that stays where it is", () => {
    const near = zoomed(RANGE, WHOLE, 0.5, 25);
    expect(near).toEqual({ start: 13, end: 61 });
    expect((25 - near.start) / (near.end - near.start)).toBeCloseTo((25 - 1) / 96);
    expect(zoomed(RANGE, near, 4, 30)).toEqual(WHOLE);
    expect(zoomed(RANGE, zoomed(RANGE, WHOLE, 1 / 1.5, 44), 1.5, 44)).toEqual(WHOLE);
    const least = zoomed(RANGE, near, 0.001, 30);
    expect(least.end - least.start).toBe(6);
  });

  it("stays in the shot", () => {
    expect(panned(RANGE, { start: 13, end: 61 }, 100)).toEqual({ start: 49, end: 97 });
    expect(panned(RANGE, { start: 13, end: 61 }, -100)).toEqual({ start: 1, end: 49 });
    expect(panned(RANGE, WHOLE, 5)).toEqual(WHOLE);
  });

  it("frames times with air, one of them too", () => {
    expect(framing(RANGE, [40, 60])).toEqual({ start: 38, end: 62 });
    expect(framing(RANGE, [50])).toEqual({ start: 47, end: 53 });
    expect(framing(RANGE, [])).toEqual(WHOLE);
    expect(framing(RANGE, [1, 97])).toEqual(WHOLE);
  });

  it("follows a time that leaves it", () => {
    const part = { start: 20, end: 40 };
    expect(containing(RANGE, part, 30)).toBe(part);
    expect(containing(RANGE, part, 50)).toEqual({ start: 32, end: 52 });
    expect(containing(RANGE, part, 10)).toEqual({ start: 8, end: 28 });
  });
});

it("the timeline follows the playhead", () => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
  const playhead = new Playhead(RANGE, 1, () => true);
  const view = new TimeView(playhead);
  expect(view.isWhole.value).toBe(true);
  view.zoom(0.25);
  expect([view.span.value, view.isWhole.value]).toEqual([{ start: 1, end: 25 }, false]);
  playhead.goTo(60);
  expect(view.span.value.start).toBeCloseTo(38.4);
  view.pan(10);
  expect(view.span.value.start).toBeCloseTo(48.4);
  view.frame([]);
  expect(view.isWhole.value).toBe(true);
  vi.unstubAllGlobals();
});

it("the axis tells frames and what lies between them apart", () => {
  const axis = timeAxis(RANGE, { start: 20, end: 40 }, 92 + 24 + 400);
  expect([axis.perFrame, axis.x(30), axis.time(axis.x(30.4))]).toEqual([20, 292, 30]);
  expect(axis.exactTime(axis.x(30.4))).toBeCloseTo(30.4);
  expect([axis.has(20), axis.has(40), axis.has(41)]).toEqual([true, true, false]);
  const still = timeAxis({ ...RANGE, end: 1 }, { start: 1, end: 1 }, 500);
  expect([still.x(1), still.time(400)]).toEqual([92, 1]);
});
