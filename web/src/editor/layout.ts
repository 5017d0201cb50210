/** Which panels are shown, and how large: remembered, but for the list of shots on a narrow page, which covers the picture. */

import { computed, signal, type Signal } from "@preact/signals";
import type { Remembered } from "./remembered";

/** Panels that can be folded. */
export const FOLDABLE = ["shots", "settings", "curve"] as const;
export type Foldable = (typeof FOLDABLE)[number];

/** Sizes between which a panel is dragged, px. */
export const LIMITS_PX: Readonly<Record<Foldable, readonly [number, number]>> = {
  shots: [160, 420],
  settings: [240, 520],
  curve: [56, 480],
};

export class Layout {
  /** Whether the page is too narrow for three columns. */
  readonly isNarrow = signal(false);
  /** Whether the list of shots covers a narrow page. */
  readonly drawer = signal(false);
  /** Sizes of the panels, px; 0 as the page has them by itself. */
  readonly sizes: Readonly<Record<Foldable, Signal<number>>>;
  readonly #remembered: Remembered;

  constructor(remembered: Remembered) {
    this.#remembered = remembered;
    const { shotsWidth: shots, settingsWidth: settings, curveHeight: curve } = remembered;
    this.sizes = { shots, settings, curve };
  }

  readonly #shown = {
    shots: computed(() => (this.isNarrow.value ? this.drawer.value : this.#remembered.shotsPanel.value === "on")),
    settings: computed(() => this.#remembered.settingsPanel.value === "on"),
    curve: computed(() => this.#remembered.curvePanel.value === "on"),
  };

  isShown(panel: Foldable): boolean {
    return this.#shown[panel].value;
  }

  toggle(panel: Foldable): void {
    this.show(panel, !this.isShown(panel));
  }

  show(panel: Foldable, isShown: boolean): void {
    if (panel === "shots" && this.isNarrow.value) this.drawer.value = isShown;
    else this.#remembered[`${panel}Panel`].value = isShown ? "on" : "off";
  }

  /** Makes a panel so large, within its limits. */
  resize(panel: Foldable, px: number): void {
    const [least, most] = LIMITS_PX[panel];
    this.sizes[panel].value = Math.round(Math.min(Math.max(px, least), most));
  }
}
