/** Choices that the page remembers between visits; undo leaves them alone. */

import { effect, signal, type Signal } from "@preact/signals";
import { Folded } from "./folded";
import type { LengthUnit } from "../model/distance";
import { REACHES, type Reach } from "../model/pull";
import { EASES, type Ease } from "../model/shot";
import { DELIVERIES, LIMITS, LOOKS, type Delivery, type Limit, type Look } from "../model/sharpness";

export const SURROUNDS = ["grey", "dark", "black"] as const;
export type Surround = (typeof SURROUNDS)[number];

export const PANELS = ["focus", "camera"] as const;
export type Panel = (typeof PANELS)[number];

export class Remembered {
  readonly unit = remembered<LengthUnit>("unit", "m", ["m", "ft"]);
  /** Brightness around the picture. */
  readonly surround = remembered<Surround>("surround", "grey", SURROUNDS);
  /** Whether focus points are drawn on the picture. */
  readonly markers = remembered<"on" | "off">("markers", "on", ["on", "off"]);
  /** Which part of the panel on the right is open. */
  readonly panel = remembered<Panel>("panel", "focus", PANELS);
  /** Whether the list of shots, the settings beside the picture, and the curve and keys below it are shown. */
  readonly shotsPanel = remembered<"on" | "off">("shotsPanel", "on", ["on", "off"]);
  readonly settingsPanel = remembered<"on" | "off">("settingsPanel", "on", ["on", "off"]);
  readonly curvePanel = remembered<"on" | "off">("curvePanel", "on", ["on", "off"]);
  /** Widths of the panels beside the picture, and height of the curve, px; 0 as the page has them by itself. */
  readonly shotsWidth = numberOf(remembered<string>("shotsWidth", "0", null), 0);
  readonly settingsWidth = numberOf(remembered<string>("settingsWidth", "0", null), 0);
  readonly curveHeight = numberOf(remembered<string>("curveHeight", "0", null), 0);
  /** Sections of the settings that are folded. */
  readonly folded = new Folded(remembered<string>("folded", "", null));
  /** Whether pictures at rest have motion blur. */
  readonly motion = remembered<"on" | "off">("motion", "off", ["on", "off"]);
  /** What is drawn over the picture of how sharp things are. */
  readonly look = remembered<Look>("look", "none", LOOKS);
  /** Whether the plane of focus and the limits of sharpness are drawn as lines. */
  readonly focusLines = remembered<"on" | "off">("focusLines", "off", ["on", "off"]);
  /** Whether the sharpness of what is under the pointer is shown beside it. */
  readonly probe = remembered<"on" | "off">("probe", "on", ["on", "off"]);
  /** What counts as sharp. */
  readonly limit = remembered<Limit>("limit", "film", LIMITS);
  /** Width of delivered pictures, px. */
  readonly delivery = remembered<Delivery>("delivery", "1920", DELIVERIES);
  /** AOVs of the render that was sent last, between commas. */
  readonly aovs = remembered<string>("aovs", "", null);
  /** What a click on the picture means. */
  readonly pull = {
    reach: remembered<Reach>("pullReach", "from", REACHES),
    frames: numberOf(remembered<string>("pullFrames", "12", null), 12),
    ease: remembered<Ease>("pullEase", "smooth", EASES),
  };
  /** Shape of the framing guide; empty for none. */
  readonly guide = remembered<string>("guide", "", null);
}

/** A number that is remembered as words. */
function numberOf(words: Signal<string>, standard: number): Signal<number> {
  const found = Number(words.peek());
  const value = signal(Number.isFinite(found) && found >= 0 ? found : standard);
  effect(() => {
    words.value = value.value.toString();
  });
  return value;
}

/** A choice (or with `choices` null any words) that is kept in the browser; private windows that keep nothing get the default each time. */
function remembered<Choice extends string>(
  name: string,
  standard: Choice,
  choices: readonly Choice[] | null,
): Signal<Choice> {
  const key = `pullfocus.${name}`;
  let kept: string | null = null;
  try {
    kept = localStorage.getItem(key);
  } catch {
    // Storage is blocked: the page works without.
  }
  const known = choices === null ? (kept as Choice | null) : choices.find((choice) => choice === kept);
  const value = signal(known ?? standard);
  effect(() => {
    try {
      localStorage.setItem(key, value.value);
    } catch {
      // As above.
    }
  });
  return value;
}

/** What the browser keeps between visits; null where it keeps nothing. */
export function localStore(): Storage | null {
  try {
    return localStorage;
  } catch {
    return null;
  }
}
