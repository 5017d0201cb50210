/** Chords of the keyboard: written as `Ctrl Shift Z`, the key last and as `KeyboardEvent.key` names it. */

export type KeyStroke = Pick<KeyboardEvent, "key" | "code" | "ctrlKey" | "metaKey" | "shiftKey" | "altKey">;

const SIGNS: Readonly<Record<string, string>> = {
  ArrowLeft: "←",
  ArrowRight: "→",
  ArrowUp: "↑",
  ArrowDown: "↓",
  Escape: "Esc",
  "-": "−",
};

const LETTER = /^[A-Z]$/;
const DIGIT = /^[0-9]$/;

/** Whether a key press is a chord. A digit is the key that it is printed on; the shift of other signs depends on the keyboard. */
export function isChord(chord: string, { key, code, ctrlKey, metaKey, shiftKey, altKey }: KeyStroke): boolean {
  const parts = chord.split(" ");
  const wanted = parts.at(-1) ?? "";
  if (parts.includes("Ctrl") !== (ctrlKey || metaKey) || parts.includes("Alt") !== altKey) return false;
  const isSign = wanted.length === 1 && !LETTER.test(wanted) && !DIGIT.test(wanted);
  if (!isSign && parts.includes("Shift") !== shiftKey) return false;
  if (DIGIT.test(wanted)) return code === `Digit${wanted}`;
  // With Alt some keyboards type other signs.
  if (LETTER.test(wanted))
    return LETTER.test(key.toUpperCase()) ? key.toUpperCase() === wanted : code === `Key${wanted}`;
  return key === (wanted === "Space" ? " " : wanted);
}

/** A chord as it is shown. */
export function shownChord(chord: string): string {
  return chord
    .split(" ")
    .map((part) => SIGNS[part] ?? part)
    .join(" ");
}
