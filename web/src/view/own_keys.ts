/** The keys that a focused control has a use of its own for, so that they are no shortcuts there. */

type Control = "text" | "select" | "slider" | "radio" | "checkbox" | "button";

/** In the order in which they are looked for. */
const SELECTORS: readonly (readonly [Control, string])[] = [
  ["radio", "[role=radio]"],
  ["slider", "input[type=range], [role=slider]"],
  ["checkbox", "input[type=checkbox]"],
  ["select", "select"],
  ["text", "input, textarea, [contenteditable=true]"],
  ["button", "button, summary, a, [role=button]"],
];

const ARROWS: readonly string[] = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"];

export function controlOf(target: Pick<Element, "matches">): Control | null {
  return SELECTORS.find(([, selector]) => target.matches(selector))?.[0] ?? null;
}

/**
 * Whether a control uses a key itself.
 *
 * @param isByKeyboard whether the keyboard has brought the focus there: Space presses a button then. After a click of the pointer it
 *   plays, as it does everywhere else.
 */
export function usesKey(control: Control | null, { key, ctrlKey, metaKey }: KeyStroke, isByKeyboard: boolean): boolean {
  switch (control) {
    case "text":
      return true;
    case "select": // it goes to the option that begins with a letter
      return !ctrlKey && !metaKey && (key !== " " || isByKeyboard);
    case "slider":
      return ARROWS.includes(key) || key === "Home" || key === "End";
    case "radio":
      return (key === " " && isByKeyboard) || ARROWS.includes(key);
    case "checkbox":
    case "button":
      return key === " " && isByKeyboard;
    case null:
      return false;
  }
}

type KeyStroke = Pick<KeyboardEvent, "key" | "ctrlKey" | "metaKey">;

/** Chooses the next radio button of a group by an arrow key, or the one before, around its ends; returns whether it was one. */
export function chooseRadio(target: Element, { key }: Pick<KeyboardEvent, "key">): boolean {
  if (controlOf(target) !== "radio" || !ARROWS.includes(key)) return false;
  const buttons = [
    ...(target.closest("[role=radiogroup]")?.querySelectorAll<HTMLElement>("[role=radio]:enabled") ?? []),
  ];
  const by = key === "ArrowRight" || key === "ArrowDown" ? 1 : -1;
  const next = buttons.at((buttons.findIndex((button) => button === target) + by) % buttons.length);
  next?.focus();
  next?.click();
  return true;
}
