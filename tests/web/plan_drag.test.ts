import { PlanDrag, Standstill } from "@/editor/plan_drag";
import { moveOnto } from "@/model/changes";
import type { Place, TopView } from "@/model/top_view";
import { PlanMoves } from "@/view/plan/plan_moves";
import { withMoved } from "@/view/plan/points";
import { turn } from "./fake_service";
import { opened } from "./pointed_session";
import { point } from "./points";

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

const PLACE = { slope: 0, nearW: 0.6, focusW: 0.5, farW: 0.4 };
/** At (0, 1, 0), looking along -Z: the point, which is at (0, 0, -2), is 2 m before it and 1 m below. */
const VIEW: TopView = {
  positionM: [0, 1, 0],
  right: [1, 0, 0],
  ahead: [0, 0, -1],
  setBackM: 0,
  gateMm: 36,
  edges: [-0.5, 0.5],
  axis: PLACE,
  cut: [PLACE],
};
const NEAR = { ...point("near"), positionM: [0, 0, -2] as const };

describe("a point that is dragged from above", () => {
  it("is previewed and then put there, at its height, by one edit", async () => {
    const { fake, session } = await opened();
    const drag = new PlanDrag(session, NEAR, VIEW);
    drag.move([1, 2]);
    drag.move([0.5, 3]);
    const moved = [{ type: "movePoint", name: "near", positionM: [0.5, 0, -3], time: 1 }];
    expect(session.document.unsaved.value).toEqual(moved);
    expect(session.selected.value).toBe("near");
    await drag.drop();
    expect(fake.made).toEqual([moved]);
    expect(session.document.unsaved.value).toEqual([]);
  });

  it("stays where it was when the drag is given up, or comes nowhere", async () => {
    const { fake, session } = await opened();
    const drag = new PlanDrag(session, NEAR, VIEW);
    await drag.drop();
    drag.move([1, 2]);
    drag.cancel();
    await turn();
    expect(fake.made).toEqual([]);
    expect([session.document.unsaved.value, session.document.dragging.value]).toEqual([[], false]);
  });

  it("is shown where it was when the service refuses", async () => {
    const { fake, session, failed } = await opened();
    fake.failing = "movePoint";
    const drag = new PlanDrag(session, NEAR, VIEW);
    drag.move([1, 2]);
    await drag.drop();
    expect(fake.made).toEqual([]);
    expect(failed).toHaveLength(1);
    expect(session.document.unsaved.value).toEqual([]);
  });
});

/** A service that is slow to make edits; each call of `make` lets it make one. */
async function slow() {
  const { fake, session } = await opened();
  const waiting: (() => void)[] = [];
  fake.gate = () => new Promise((resolve) => waiting.push(resolve));
  const shown: (Place | null)[] = [];
  const moves = new PlanMoves((place) => shown.push(place));
  const step = (): void => {
    moves.move([(moves.place?.[0] ?? 0) + 1, 2], () => new PlanDrag(session, NEAR, VIEW));
  };
  const make = async (): Promise<void> => {
    waiting.shift()?.();
    await turn();
  };
  const sent = () => fake.made.map(([change]) => change && "positionM" in change && change.positionM);
  return { moves, step, make, shown, sent };
}

describe("quick moves from above", () => {
  it("go on from each other, before they are saved", async () => {
    const { moves, step, make, shown, sent } = await slow();
    for (let k = 0; k < 2; k += 1) {
      step();
      void moves.end(true);
      await turn();
    }
    await make();
    expect(shown.at(-1)).toEqual([2, 2]);
    step();
    void moves.end(true);
    await make();
    expect(shown.at(-1)).toEqual([3, 2]);
    await make();
    expect([shown.at(-1), moves.place]).toEqual([null, null]);
    expect(sent()).toEqual([[1, 0, -2], [2, 0, -2], [3, 0, -2]]); // prettier-ignore
  });

  it("that are given up leave the one before them", async () => {
    const { moves, step, make, shown, sent } = await slow();
    step();
    void moves.end(true);
    step();
    void moves.end(false);
    expect(shown.at(-1)).toEqual([1, 2]);
    await turn();
    await make();
    expect(shown.at(-1)).toBe(null);
    expect(sent()).toEqual([[1, 0, -2]]);
  });

  it("let go of the pointer that they follow", async () => {
    const { moves } = await slow();
    const unfollow = vi.fn();
    moves.follow(unfollow);
    expect([moves.isTaken, moves.isHeld]).toEqual([true, false]);
    await moves.end(false);
    expect(unfollow).toHaveBeenCalledOnce();
    expect(moves.isTaken).toBe(false);
  });

  it("of several points are shown beside each other", () => {
    const both = withMoved(withMoved(new Map(), 1, [1, 1]), 2, [2, 2]);
    expect([...withMoved(both, 1, null)]).toEqual([[2, [2, 2]]]);
    expect([...withMoved(both, 2, [3, 3])]).toEqual([[1, [1, 1]], [2, [3, 3]]]); // prettier-ignore
  });
});

describe("a drag while the shot plays", () => {
  it("begins once point and camera are those of the frame where it stops", async () => {
    const { session } = await opened();
    const { document, playhead, topView } = session;
    vi.spyOn(topView.view, "peek").mockReturnValue(VIEW);
    const standstill = new Standstill(session);
    const stale = { ...NEAR };
    expect(standstill.comesWith(stale, VIEW)).toBe(true); // nothing plays
    playhead.playing.value = true;
    expect(standstill.comesWith(stale, VIEW)).toBe(false);
    expect(playhead.playing.value).toBe(false);
    await turn();
    const [point] = document.points.value;
    if (!point) throw new Error("no point");
    expect(standstill.comesWith(point, { ...VIEW })).toBe(false);
    topView.reading.value = true;
    expect(standstill.comesWith(point, VIEW)).toBe(false);
    topView.reading.value = false;
    expect(standstill.comesWith(point, VIEW)).toBe(true);
    expect(standstill.comesWith(stale, VIEW)).toBe(true); // it stands still by now
  });
});

it("a point that was moved from above is put onto a surface without its offset", () => {
  const to = { place: [0.2, 0.5] } as const;
  const move = { type: "movePoint", name: "near", place: [0.2, 0.5], time: 3 };
  expect(moveOnto(point("near"), to, 3)).toEqual([move]);
  expect(moveOnto(point("near", {}, { offset: [0, 0, 1] }), to, 3)).toEqual([
    { type: "alterPoint", name: "near", values: { offset: [0, 0, 0] }, time: 3 },
    move,
  ]);
});
