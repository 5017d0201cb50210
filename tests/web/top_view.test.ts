import {
  edgesOf,
  endsOf,
  fitted,
  fromSheet,
  gridOf,
  headingOf,
  leastWOf,
  lineOf,
  movedTo,
  panned,
  placeOnPath,
  residualOf,
  toPlan,
  toSheet,
  wedgeOf,
  withReadout,
  zoomed,
  type CutPlace,
  type Place,
  type Sheet,
  type TopView,
} from "@/model/top_view";

/** Sharp from 2 to 4 m, focused at 8/3 m: w of 0.5, 0.375 and 0.25. */
function upright(slope: number): CutPlace {
  return { slope, nearW: 0.5, focusW: 0.375, farW: 0.25 };
}

/** At (1, 2, 3), looking along -Z; its picture is as wide as it is far. */
const VIEW: TopView = {
  positionM: [1, 2, 3],
  right: [1, 0, 0],
  ahead: [0, 0, -1],
  setBackM: 0,
  gateMm: 36,
  edges: [-0.5, 0.5],
  axis: upright(0),
  cut: [-0.5, 0, 0.5].map(upright),
};
/** Swung: w is 0.2 + 0.4 × slope at the focus, so that it is 0 at the left edge, and 0.1 to both sides of that. */
const SWUNG: TopView = {
  ...VIEW,
  cut: [-0.5, 0, 0.5].map((slope) => {
    const focusW = 0.2 + 0.4 * slope;
    return { slope, nearW: focusW + 0.1, focusW, farW: focusW - 0.1 };
  }),
};
const SHEET: Sheet = { width: 400, height: 300, pxPerM: 50, middle: [0, 3], turn: 0 };

function near(places: readonly (readonly number[])[]): unknown[] {
  return places.map((place) => place.map((value) => expect.closeTo(value, 9) as number));
}

describe("a place of the world in the plan", () => {
  it("is its distance to the right and its depth, however high it is", () => {
    expect(toPlan(VIEW, [1.5, 7, -1])).toEqual([0.5, 4]);
  });

  it("has the depth along the axis of a camera that looks down", () => {
    const [cos, sin] = [Math.cos(0.3), Math.sin(0.3)];
    const pitched: TopView = { ...VIEW, ahead: [0, -sin, -cos] };
    const at = [1, 2 - 5 * sin, 3 - 5 * cos] as const;
    expect([toPlan(pitched, at)]).toEqual(near([[0, 5]]));
  });

  it("is moved to another one at the same height", () => {
    const moved = movedTo(VIEW, [1.5, 7, -1], [2, 3]);
    expect(moved).toEqual([3, 7, 0]);
    expect(toPlan(VIEW, moved)).toEqual([2, 3]);
  });
});

describe("the cut through what is sharp", () => {
  it("has upright planes square to the axis, from edge to edge", () => {
    expect(lineOf(VIEW, "focusW", 0.01)).toEqual([near([[-4 / 3, 8 / 3], [0, 8 / 3], [4 / 3, 8 / 3]])]); // prettier-ignore
    expect(wedgeOf(VIEW, 0.01)).toEqual(near([[-1, 2], [0, 2], [1, 2], [2, 4], [0, 4], [-2, 4]])); // prettier-ignore
  });

  it("ends at a limit where a swung plane goes to infinity", () => {
    // The focus is at w = 0.1 where the slope is -0.25: at 10 m, 2.5 m to the left.
    const [line, ...others] = lineOf(SWUNG, "focusW", 0.1);
    expect(others).toEqual([]);
    expect(line).toEqual(near([[-2.5, 10], [0, 5], [1.25, 2.5]])); // prettier-ignore
  });

  it("has a swung plane as one straight line", () => {
    const [line] = lineOf(SWUNG, "focusW", 0.01);
    // 1 = 0.2 × depth + 0.4 × right, of w = 0.2 + 0.4 × slope times the depth.
    for (const [right, depth] of line ?? []) expect(0.2 * depth + 0.4 * right).toBeCloseTo(1, 9);
    expect(line?.length).toBe(3);
  });

  it("reaches to the limit where the far one is infinite", () => {
    const endless: TopView = { ...VIEW, cut: VIEW.cut.map((place) => ({ ...place, farW: -0.1 })) };
    expect(lineOf(endless, "farW", 0.1)).toEqual([]);
    expect(wedgeOf(endless, 0.1)).toEqual(near([[-1, 2], [0, 2], [1, 2], [5, 10], [0, 10], [-5, 10]])); // prettier-ignore
  });

  it("is everything before a pinhole", () => {
    const pinhole = VIEW.cut.map((place) => ({ ...place, nearW: Infinity, farW: -Infinity }));
    expect(wedgeOf({ ...VIEW, cut: pinhole }, 0.1).filter(([right, depth]) => right === 0 && depth === 0)).toHaveLength(
      3,
    );
    expect(lineOf({ ...VIEW, cut: pinhole }, "nearW", 0.1)).toEqual([]);
  });

  it("is seen from behind the origin of an orthographic camera", () => {
    const back: TopView = { ...VIEW, setBackM: 1 };
    expect(edgesOf(back, 0.25)).toEqual([[[0, -1], [-2, 3]], [[0, -1], [2, 3]]]); // prettier-ignore
    expect(lineOf(back, "nearW", 0.01)[0]?.[1]).toEqual([0, 1]);
  });
});

describe("a lens that has changed", () => {
  it("moves the cut to its readout", () => {
    const changed = withReadout(VIEW, { focusDistanceM: 4, nearM: 10 / 3 });
    const { nearW, focusW, farW } = changed.cut[2] ?? upright(0);
    expect([nearW, focusW, farW]).toEqual(near([[0.3, 0.25, 0.2]])[0]);
  });

  it("leaves the slant of the cut, and deepens it alike", () => {
    const axis = { slope: 0, nearW: 0.3, focusW: 0.2, farW: 0.1 };
    const changed = withReadout({ ...SWUNG, axis }, { focusDistanceM: 4, nearM: 1 / 0.45 });
    const { nearW, focusW, farW } = changed.cut[2] ?? upright(0);
    expect([nearW, focusW, farW]).toEqual(near([[0.65, 0.45, 0.25]])[0]);
  });

  it("that has not is left as it was read", () => {
    expect(withReadout(VIEW, { focusDistanceM: 8 / 3, nearM: 2 })).toBe(VIEW);
  });

  it("is sharp from its pupil on, stopped down to a pinhole", () => {
    const { nearW, farW } = withReadout(VIEW, { focusDistanceM: 4, nearM: 0 }).axis;
    expect([nearW, farW]).toEqual([Infinity, -Infinity]);
  });
});

describe("how far a point is off the focus", () => {
  it("is along its ray, as deep as the readout says", () => {
    const [from, to] = residualOf(VIEW, [1, 4], 8 / 3, 0.01);
    expect(from).toEqual([1, 4]);
    expect([to]).toEqual(near([[2 / 3, 8 / 3]]));
    expect(from[1] - to[1]).toBeCloseTo(4 - 8 / 3, 9);
  });

  it("goes to the limit where the focus is infinite", () => {
    expect(residualOf(VIEW, [1, 4], Infinity, 0.1)[1]).toEqual(near([[2.5, 10]])[0]);
  });
});

describe("a drawing", () => {
  it("is to scale, with the camera's way up", () => {
    expect(toSheet(SHEET, [0, 3])).toEqual([200, 150]);
    expect(toSheet(SHEET, [1, 5])).toEqual([250, 50]);
    expect(fromSheet(SHEET, [250, 50])).toEqual([1, 5]);
  });

  it("is turned about its middle", () => {
    const east: Sheet = { ...SHEET, middle: [0, 0], turn: Math.PI / 2 };
    expect(toSheet(east, [0, 1])).toEqual(near([[250, 150]])[0]);
    expect(fromSheet(east, [250, 150])).toEqual(near([[0, 1]])[0]);
  });

  it("is zoomed at a spot, and shifted", () => {
    const twice = zoomed(SHEET, 2, [250, 50]);
    expect(twice.pxPerM).toBe(100);
    expect(fromSheet(twice, [250, 50])).toEqual(near([[1, 5]])[0]);
    expect(toSheet(panned(SHEET, 10, -20), [0, 3])).toEqual(near([[210, 130]])[0]);
  });

  it("shows all of some places", () => {
    const { pxPerM, middle } = fitted(SHEET, [[-1, 0], [3, 4]], 50); // prettier-ignore
    expect([pxPerM, ...middle]).toEqual(near([[50, 1, 2]])[0]);
  });

  it("shows all of more places than a call takes arguments", () => {
    const places = Array.from({ length: 150_000 }, (_, at): Place => [(at % 5) - 1, at % 5]);
    expect(fitted(SHEET, places, 50)).toEqual(fitted(SHEET, [[-1, 0], [3, 4]], 50)); // prettier-ignore
    expect(endsOf(places, 1)).toEqual([0, 4]);
  });

  it("has a limit beyond all that it shows", () => {
    expect(leastWOf(SHEET, VIEW)).toBeCloseTo(1 / (1.05 * 6), 9);
  });
});

describe("the grid", () => {
  it("has round steps in the unit, from the camera on", () => {
    const { step, stepM, rights, depths } = gridOf(SHEET, "m", 40);
    expect([step, stepM]).toEqual([1, 1]);
    expect(depths).toEqual([0, 1, 2, 3, 4, 5, 6]);
    expect(rights).toEqual([-4, -3, -2, -1, 0, 1, 2, 3, 4]);
    expect(gridOf(SHEET, "m", 60).step).toBe(2);
    expect(gridOf({ ...SHEET, pxPerM: 500 }, "m", 40).step).toBeCloseTo(0.1, 9);
  });

  it("counts feet where the page does", () => {
    const { step, stepM } = gridOf(SHEET, "ft", 60);
    expect(step).toBe(5);
    expect(stepM).toBeCloseTo(5 * 0.3048, 9);
  });
});

describe("the heading of a camera", () => {
  it("is clockwise from north", () => {
    expect(headingOf(VIEW)).toBeCloseTo(0, 9);
    expect(headingOf({ ...VIEW, right: [0, 0, 1], ahead: [1, 0, 0] })).toBeCloseTo(Math.PI / 2, 9);
  });

  it("that looks down is that of its picture's top", () => {
    expect(headingOf({ ...VIEW, ahead: [0, -1, 0] })).toBeCloseTo(0, 9);
  });
});

describe("a path", () => {
  const paths = { times: [1, 2, 3], cameraM: [], points: [] };
  it("is known at its times and between them", () => {
    const way = [[0, 0, 0], [1, 0, 2], null] as const; // prettier-ignore
    expect(placeOnPath(paths, way, 2)).toEqual([1, 0, 2]);
    expect(placeOnPath(paths, way, 1.5)).toEqual([0.5, 0, 1]);
    expect(placeOnPath(paths, way, 2.5)).toBeNull();
    expect(placeOnPath(paths, way, 9)).toBeNull();
  });
});
