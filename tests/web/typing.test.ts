import { Typing } from "@/view/controls/typing";
import { parseQuantity } from "@/view/numbers";

function parse(text: string): number | null {
  return parseQuantity(text, "mm");
}

describe("a typed number", () => {
  it("is entered once", () => {
    const typing = new Typing();
    typing.type("50 mm");
    expect(typing.enter(parse)).toBe(50);
    expect(typing.text.value).toBeNull();
    expect(typing.enter(parse)).toBeNull(); // as the box is left
  });

  it("that is given up is not entered as the box is left", () => {
    const typing = new Typing();
    typing.type("50");
    typing.giveUp();
    expect([typing.enter(parse), typing.text.value]).toEqual([null, null]);
  });

  it("that cannot be read stays and says so, until it is typed anew or given up", () => {
    const typing = new Typing();
    typing.type("wide");
    expect(typing.refused.value).toBe(false);
    expect([typing.enter(parse), typing.text.value, typing.refused.value]).toEqual([null, "wide", true]);
    typing.type("24");
    expect([typing.refused.value, typing.enter(parse)]).toEqual([false, 24]);
    typing.type("wide");
    typing.enter(parse);
    typing.giveUp();
    expect([typing.text.value, typing.refused.value]).toEqual([null, false]);
  });

  it("that was emptied is none, and nothing is wrong with it", () => {
    const typing = new Typing();
    typing.type(" ");
    expect([typing.enter(parse), typing.text.value, typing.refused.value]).toEqual([null, null, false]);
  });
});
