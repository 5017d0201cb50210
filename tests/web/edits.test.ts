import { removePoint, setAttribute, setFocusMode, setLens, toggleKey, together } from "@/model/command";
import type { Curve, CurveSample } from "@/model/curve";
import { emptyHistory, moved, pushed, redoable, undoable } from "@/model/history";
import type { Readout } from "@/model/shot";
import { point } from "./points";

const readout: Readout = {
  fStop: 2,
  focalLengthMm: 50,
  focusDistanceM: 3,
  nearM: 2.9,
  farM: 3.1,
  hyperfocalM: 60,
  source: "points",
  reason: "",
  focusMode: "points",
  lensName: "",
  lensModel: "thin",
};

function curve(...samples: Partial<CurveSample>[]): Curve {
  return samples.map((sample, at) => ({ ...readout, time: at + 1, points: [], ...sample }));
}

describe("changes", () => {
  it("what is not keyed changes for the whole shot", () => {
    const change = setAttribute(point("a"), "weight", 0.3, 12);
    expect(change.redo).toEqual([{ do: "changePoint", name: "a", change: { weight: 0.3 } }]);
    expect(change.undo).toEqual([{ do: "changePoint", name: "a", change: { weight: 1 } }]);
  });

  it("what is keyed gets a key at the time, and undo removes it again", () => {
    const change = setAttribute(point("a", { weight: { 1: 1 } }), "weight", 0.3, 12);
    expect(change.redo).toMatchObject([{ do: "setKey", key: { time: 12, value: 0.3 } }]);
    expect(change.undo).toEqual([{ do: "removeKey", name: "a", attribute: "weight", time: 12 }]);
  });

  it("undo of a changed key is the key as it was", () => {
    const change = setAttribute(point("a", { weight: { 12: 0.9 } }), "weight", 0.3, 12);
    expect(change.undo).toMatchObject([{ do: "setKey", key: { time: 12, value: 0.9 } }]);
  });

  it("the key button keeps the value and only keys it", () => {
    const on = toggleKey(point("a", {}, { weight: 0.7 }), "weight", 5);
    expect(on.redo).toMatchObject([{ do: "setKey", key: { time: 5, value: 0.7 } }]);
    const off = toggleKey(point("a", { weight: { 5: 0.7 } }), "weight", 5);
    expect(off.redo).toMatchObject([{ do: "removeKey", time: 5 }]);
  });

  it("a removed point comes back with all its keys", () => {
    const change = removePoint(point("a", { weight: { 1: 1, 9: 0 }, enabled: { 4: 1 } }));
    expect(change.redo).toEqual([{ do: "removePoint", name: "a" }]);
    expect(change.undo.map((command) => command.do)).toEqual(["addPoint", "setKey", "setKey", "setKey"]);
  });

  it("several changes are undone last to first", () => {
    const both = together(setFocusMode("manual", "points"), removePoint(point("a")));
    expect(both.undo[0]).toMatchObject({ do: "addPoint" });
    expect(both.undo.at(-1)).toMatchObject({ do: "setLens", change: { focusMode: "points" } });
  });
});

describe("the lens", () => {
  it("undo of a hand on the focus ring gives the focus back to the points", () => {
    const change = setLens("focusDistanceM", 5, 10, readout, curve({}, { focusDistanceM: 4 }));
    expect(change.redo).toEqual([{ do: "setLens", change: { focusDistanceM: 5 }, time: null }]);
    expect(change.undo).toMatchObject([{ change: { focusDistanceM: 3, focusMode: "points" } }]);
  });

  it("a still lens changes for the whole shot, a zoom gets a key", () => {
    expect(setLens("focalLengthMm", 35, 10, readout, curve({}, {})).redo).toMatchObject([{ time: null }]);
    const zoom = curve({ focalLengthMm: 50 }, { focalLengthMm: 60 });
    expect(setLens("focalLengthMm", 35, 10, readout, zoom).redo).toMatchObject([{ time: 10 }]);
  });

  it("saying again who focuses changes nothing", () => {
    expect(setFocusMode("points", "points").redo).toEqual([]);
  });
});

describe("history", () => {
  const edit = (label: string): { label: string; redo: string[]; undo: string[] } => ({ label, redo: [], undo: [] });

  it("undo and redo walk over the edits and stop at both ends", () => {
    let history = pushed(pushed(emptyHistory<string>(), edit("a")), edit("b"));
    expect(undoable(history)?.label).toBe("b");
    history = moved(moved(moved(history, -1), -1), -1);
    expect(undoable(history)).toBeNull();
    expect(redoable(history)?.label).toBe("a");
    history = moved(moved(moved(history, 1), 1), 1);
    expect(redoable(history)).toBeNull();
  });

  it("a new edit forgets what was undone", () => {
    const history = pushed(moved(pushed(emptyHistory<string>(), edit("a")), -1), edit("c"));
    expect(history.edits.map(({ label }) => label)).toEqual(["c"]);
  });
});
