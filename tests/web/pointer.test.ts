import { followPointer } from "@/view/hooks";

/** An element with a pointer down on it, and what follows the pointer heard. */
function followed(): { send: (type: string) => void; heard: string[]; stop: () => void } {
  const element = Object.assign(new EventTarget(), { setPointerCapture: () => undefined });
  const heard: string[] = [];
  const listen = (event: Event): void => void heard.push(event.type);
  const down = { currentTarget: element, pointerId: 1 } as unknown as PointerEvent;
  const stop = followPointer(down, listen, listen);
  return { send: (type) => element.dispatchEvent(new Event(type)), heard, stop };
}

describe("a pointer that is down", () => {
  it("is followed until it is let go", () => {
    const { send, heard } = followed();
    for (const type of ["pointermove", "pointerup", "pointermove"]) send(type);
    expect(heard).toEqual(["pointermove", "pointerup"]);
  });

  it("is followed no more once that is ended", () => {
    const { send, heard, stop } = followed();
    stop();
    for (const type of ["pointermove", "pointerup"]) send(type);
    expect(heard).toEqual([]);
  });
});
