import { FocusMoves } from "@/view/plan/focus_moves";

/** A handle with a pointer down on it, and what its drags do. */
function held(): { moves: FocusMoves; heard: string[]; point: (type: string, depth?: number) => void } {
  const handle = Object.assign(new EventTarget(), { setPointerCapture: () => undefined });
  const heard: string[] = [];
  const moves = new FocusMoves();
  const down = { currentTarget: handle, pointerId: 1 } as unknown as PointerEvent;
  const start = () => ({
    move: (value: number) => void heard.push(`move ${String(value)}`),
    commit: (value: number) => void heard.push(`set ${String(value)}`),
    cancel: () => void heard.push("cancel"),
  });
  moves.follow(down, ({ clientY }) => clientY, start);
  const point = (type: string, clientY = 0): void =>
    void handle.dispatchEvent(Object.assign(new Event(type), { clientY }));
  return { moves, heard, point };
}

describe("the focus distance from above", () => {
  it("follows a pointer, and is set where that is let go", () => {
    const { moves, heard, point } = held();
    point("pointermove", 2);
    expect([moves.isTaken, moves.value]).toEqual([true, 2]);
    point("pointermove", 3);
    point("pointerup");
    expect(heard).toEqual(["move 2", "move 3", "set 3"]);
    expect([moves.isTaken, moves.value]).toEqual([false, null]);
  });

  it.each([[1], [0]])("follows a pointer no more once given up, after %s moves", (count) => {
    const { moves, heard, point } = held();
    for (let k = 0; k < count; k += 1) point("pointermove", 2);
    expect(moves.isTaken).toBe(true);
    moves.end(false);
    for (const type of ["pointermove", "pointerup"]) point(type, 5);
    expect(heard).toEqual(count ? ["move 2", "cancel"] : []);
  });

  it("is given up where the pointer is taken away", () => {
    const { heard, point } = held();
    point("pointermove", 2);
    point("pointercancel");
    expect(heard).toEqual(["move 2", "cancel"]);
  });
});
