/** Which sections of the settings are folded, remembered as their names between commas. */

import type { Signal } from "@preact/signals";

export class Folded {
  readonly #names: Signal<string>;

  constructor(names: Signal<string>) {
    this.#names = names;
  }

  has(name: string): boolean {
    return this.#names.value.split(",").includes(name);
  }

  toggle(name: string): void {
    const others = this.#names.value.split(",").filter((other) => other !== "" && other !== name);
    this.#names.value = (this.has(name) ? others : [...others, name]).join(",");
  }
}
