/** Text that is typed in place of a number, until it is entered or given up. */

import { signal } from "@preact/signals";

export class Typing {
  /** Null where nothing is typed, and the number shows. */
  readonly text = signal<string | null>(null);
  /** Whether the text was entered and is no number. */
  readonly refused = signal(false);

  type(text: string): void {
    this.text.value = text;
    this.refused.value = false;
  }

  /** Returns the number that was typed, or null for none; a text that is no number stays. */
  enter(parse: (text: string) => number | null): number | null {
    const text = this.text.peek() ?? "";
    const typed = parse(text);
    if (typed === null && text.trim() !== "") this.refused.value = true;
    else this.giveUp();
    return typed;
  }

  giveUp(): void {
    this.text.value = null;
    this.refused.value = false;
  }
}
