import { chooseRadio, controlOf, usesKey } from "@/view/own_keys";

/** An element that only the given selectors match. */
function matching(...selectors: string[]): Pick<Element, "matches"> {
  return { matches: (list) => list.split(", ").some((selector) => selectors.includes(selector)) };
}

const [BUTTON, SELECT, PAGE] = [matching("button"), matching("select"), matching("main")];
const CHECKBOX = matching("input", "input[type=checkbox]");
const SLIDER = matching("input", "input[type=range]");

function uses(target: Pick<Element, "matches">, key: string, ctrlKey = false, isByKeyboard = true): boolean {
  return usesKey(controlOf(target), { key, ctrlKey, metaKey: false }, isByKeyboard);
}

describe("keys that are shortcuts elsewhere", () => {
  it("go to text, all of them", () => {
    for (const key of ["k", " ", "Delete", "ArrowLeft", "Escape"]) expect(uses(matching("input"), key)).toBe(true);
    expect(uses(matching("textarea"), "z", true)).toBe(true);
  });

  it("go to a list of choices, undo apart", () => {
    for (const key of ["k", " ", "Delete", "[", "ArrowLeft"]) expect(uses(SELECT, key)).toBe(true);
    expect(uses(SELECT, "z", true)).toBe(false);
  });

  it("go to switches and buttons where they press them", () => {
    for (const target of [CHECKBOX, BUTTON]) {
      expect(uses(target, " ")).toBe(true);
      for (const key of ["k", "Delete", "[", "ArrowLeft"]) expect(uses(target, key)).toBe(false);
    }
  });

  it("play by Space on what the pointer has clicked", () => {
    for (const target of [CHECKBOX, BUTTON, SELECT, matching("[role=radio]")])
      expect(uses(target, " ", false, false)).toBe(false);
    expect(uses(matching("input"), " ", false, false)).toBe(true);
  });

  it("go to sliders where they move them", () => {
    for (const key of ["ArrowLeft", "Home", "End"]) expect(uses(SLIDER, key)).toBe(true);
    for (const key of [" ", "k"]) expect(uses(SLIDER, key)).toBe(false);
  });

  it("go nowhere else", () => {
    for (const key of [" ", "k", "Delete", "ArrowLeft"]) expect(uses(PAGE, key)).toBe(false);
  });
});

describe("a group of radio buttons", () => {
  /** Three buttons; which was chosen last. */
  function group(): { buttons: Element[]; chosen: () => number } {
    let chosen = -1;
    const buttons: Element[] = [0, 1, 2].map((at) => {
      const closest = (): unknown => ({ querySelectorAll: () => buttons });
      const press = { focus: () => undefined, click: () => (chosen = at) };
      return { ...matching("button", "[role=radio]"), closest, ...press } as unknown as Element;
    });
    return { buttons, chosen: () => chosen };
  }

  it.each([
    [0, "ArrowRight", 1],
    [2, "ArrowDown", 0],
    [0, "ArrowLeft", 2],
    [1, "ArrowUp", 0],
  ])("from the button %i goes by %s to %i", (from, key, to) => {
    const { buttons, chosen } = group();
    const button = buttons[from];
    expect(button && chooseRadio(button, { key })).toBe(true);
    expect(chosen()).toBe(to);
  });

  it("leaves other keys alone", () => {
    const { buttons, chosen } = group();
    expect(buttons[0] && chooseRadio(buttons[0], { key: "Home" })).toBe(false);
    expect(chosen()).toBe(-1);
  });
});
