import { goToOther } from "@/editor/viewers";
import type { Editor } from "@/editor/editor";
import { byFrame, nextOther, othersOf, type Other, type Viewers } from "@/model/viewers";
import { SHOT } from "./fake_service";
import { opened } from "./pointed_session";

function told(...viewers: readonly (readonly [string, number, number | null])[]): Viewers {
  const list = viewers.map(([name, number, time]) => ({ id: `v${number}`, name, number, camera: null, time }));
  return { you: "v1", viewers: list };
}

function other(label: string, time: number | null, camera: string | null = null): Other {
  return { id: label, label, initials: label, colour: "red", camera, time };
}

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", vi.fn());
});
afterEach(() => {
  vi.unstubAllGlobals();
});

describe("others", () => {
  it("are told apart by name and number, and are not this page", () => {
    const others = othersOf(told(["Mara Jensen", 1, 2], ["anyone", 2, 3], ["Mara Jensen", 3, 4], ["Jon", 5, null]));
    expect(others.map(({ label, initials, time }) => [label, initials, time])).toEqual([
      ["Guest 2", "G2", 3],
      ["Mara Jensen (2)", "MJ", 4],
      ["Jon", "Jo", null],
    ]);
  });

  it("have a colour for each person, also in several tabs", () => {
    const colours = othersOf(told(["a", 1, 1], ["b", 2, 1], ["anyone", 3, 1], ["b", 4, 1])).map(({ colour }) => colour);
    expect(colours[0]).toBe(colours[2]);
    expect(new Set(colours).size).toBe(2);
  });

  it("gather at frames", () => {
    const gathered = byFrame([other("a", 3), other("b", null), other("c", 5), other("d", 3)]);
    expect(gathered.map(({ time, others }) => [time, others.map(({ label }) => label)])).toEqual([
      [3, ["a", "d"]],
      [5, ["c"]],
    ]);
  });

  it("are gone to one after the other", () => {
    const others = [other("a", 3), other("b", null), other("c", 5, "/wide"), other("d", 3, "/wide")];
    const next = (time: number, camera: string): string | undefined => nextOther(others, time, camera)?.label;
    expect([next(1, "/cam"), next(3, "/cam"), next(5, "/wide"), next(3, "/wide")]).toEqual(["a", "c", "a", "c"]);
    expect(nextOther([other("b", null)], 1, null)).toBeNull();
    const between = [other("a", 12.5), other("b", 20)];
    expect(nextOther(between, 13, null)?.label).toBe("b"); // the playhead went to a whole frame
  });
});

describe("the frame of somebody else", () => {
  it("is gone to, through the same camera where the shot has it", async () => {
    const { session } = await opened();
    const open = vi.fn(() => Promise.resolve());
    const editor = { session: { value: session }, open } as unknown as Editor;
    await goToOther(editor, other("a", 12));
    await goToOther(editor, other("a", 13, "/gone"));
    expect(session.playhead.time.value).toBe(13);
    await goToOther(editor, other("a", null));
    expect(open).not.toHaveBeenCalled();
    (session.shot.cameraPaths as string[]).push("/wide");
    await goToOther(editor, other("a", 14, "/wide"));
    (session.shot.cameraPaths as string[]).pop();
    expect(open).toHaveBeenCalledWith(SHOT.id, "/wide", 14);
  });
});
