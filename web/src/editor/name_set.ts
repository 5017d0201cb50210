/** Names of which some are chosen, remembered as one text with commas between them. */

import type { Signal } from "@preact/signals";

export class NameSet {
  readonly #text: Signal<string>;

  constructor(text: Signal<string>) {
    this.#text = text;
  }

  /** The chosen names, in the order in which they were chosen. */
  get names(): readonly string[] {
    return this.#text.value.split(",").filter((name) => name !== "");
  }

  set names(names: readonly string[]) {
    this.#text.value = names.join(",");
  }

  has(name: string): boolean {
    return this.names.includes(name);
  }

  toggle(name: string): void {
    this.names = this.has(name) ? this.names.filter((other) => other !== name) : [...this.names, name];
  }
}
