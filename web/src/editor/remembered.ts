/** Choices that the page remembers between visits; undo leaves them alone. */

import { effect, signal, type Signal } from "@preact/signals";
import { EXPOSURE_LOOKS, ZEBRA_STOPS, type ExposureLook, type ZebraStops } from "../model/exposure_map";
import { STANDARD_FACTS } from "../model/burn_in";
import type { LengthUnit } from "../model/distance";
import { SAFE_WITHIN, STANDARD_MASK, type SafeWithin } from "../model/guides";
import { NameSet } from "./name_set";
import { REACHES, type Reach } from "../model/pull";
import { WAYS, type Way } from "../model/gamepad";
import { ORIGINS, type Origin } from "../model/ring";
import { SCOPES } from "../model/scopes";
import { EASES, type Ease } from "../model/shot";
import { DELIVERIES, LIMITS, LOOKS, type Delivery, type Limit, type Look } from "../model/sharpness";

export const SURROUNDS = ["grey", "dark", "black"] as const;
export type Surround = (typeof SURROUNDS)[number];

export const PANELS = ["focus", "camera"] as const;
export type Panel = (typeof PANELS)[number];

export const PLAN_UPS = ["camera", "north"] as const;
export type PlanUp = (typeof PLAN_UPS)[number];

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
  readonly folded = new NameSet(remembered<string>("folded", "", null));
  /** Whether pictures at rest have motion blur. */
  readonly motion = remembered<"on" | "off">("motion", "off", ["on", "off"]);
  /** What is drawn over the picture of how sharp things are. */
  readonly look = remembered<Look>("look", "none", LOOKS);
  /** What is drawn over the picture of how bright things are, and from how many stops above grey there are stripes. */
  readonly exposureLook = remembered<ExposureLook>("exposureLook", "none", EXPOSURE_LOOKS);
  readonly zebraStops = remembered<ZebraStops>("zebraStops", "2.5", ZEBRA_STOPS);
  /** Whether scopes of the picture are shown below it, and which. */
  readonly scopes = remembered<"on" | "off">("scopes", "off", ["on", "off"]);
  readonly chosenScopes = new NameSet(remembered<string>("chosenScopes", SCOPES.join(","), null));
  /** Whether the plane of focus and the limits of sharpness are drawn as lines. */
  readonly focusLines = remembered<"on" | "off">("focusLines", "off", ["on", "off"]);
  /** Whether the sharpness of what is under the pointer is shown beside it. */
  readonly probe = remembered<"on" | "off">("probe", "on", ["on", "off"]);
  /** Whether the set is shown from above, beside the picture. */
  readonly topView = remembered<"on" | "off">("topView", "off", ["on", "off"]);
  /** Which way is up in it: where the camera looks, or the north of the world. */
  readonly planUp = remembered<PlanUp>("planUp", "camera", PLAN_UPS);
  /** What counts as sharp. */
  readonly limit = remembered<Limit>("limit", "film", LIMITS);
  /** Width of delivered pictures, px. */
  readonly delivery = remembered<Delivery>("delivery", "1920", DELIVERIES);
  /** AOVs of the render that was sent last, between commas. */
  readonly aovs = remembered<string>("aovs", "", null);
  /** What the render made that was sent last, between commas. */
  readonly delivered = remembered<string>("delivered", "", null);
  /** What a click on the picture means. */
  readonly pull = {
    reach: remembered<Reach>("pullReach", "from", REACHES),
    frames: numberOf(remembered<string>("pullFrames", "12", null), 12),
    ease: remembered<Ease>("pullEase", "smooth", EASES),
  };
  /** The focus ring: whether it is shown, where its distances count from, whether marks draw it and the picture follows it. */
  readonly ring = {
    shown: remembered<"on" | "off">("ring", "off", ["on", "off"]),
    origin: remembered<Origin>("ringOrigin", "film", ORIGINS),
    snaps: remembered<"on" | "off">("ringSnaps", "off", ["on", "off"]),
    follows: remembered<"on" | "off">("ringFollows", "on", ["on", "off"]),
    /** What of a MIDI device and of a game controller turns it; empty for nothing. */
    midi: remembered<string>("ringMidi", "", null),
    lever: remembered<string>("ringLever", "", null),
    way: remembered<Way>("ringWay", "absolute", WAYS),
  };
  /** Shapes of the framing guides, and the other marks on the ground glass. */
  readonly guides = new NameSet(remembered<string>("guides", keptBefore("guide"), null));
  readonly marks = new NameSet(remembered<string>("guideMarks", "", null));
  /** What the safe areas are of, and how dark it is outside of the smallest guide, %. */
  readonly safeWithin = remembered<SafeWithin>("safeWithin", "picture", SAFE_WITHIN);
  readonly mask = numberOf(remembered<string>("guideMask", STANDARD_MASK.toString(), null), STANDARD_MASK);
  /** Facts that are written in the corners of the picture, and whether they are. */
  readonly burnIn = new NameSet(remembered<string>("burnIn", STANDARD_FACTS.join(","), null));
  readonly burnInShown = remembered<"on" | "off">("burnInShown", "off", ["on", "off"]);
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

/** What an earlier page kept under a name that is no longer used, which is forgotten. */
function keptBefore(name: string): string {
  const key = `pullfocus.${name}`;
  try {
    const kept = localStorage.getItem(key) ?? "";
    localStorage.removeItem(key);
    return kept;
  } catch {
    return ""; // Storage is blocked: nothing was kept.
  }
}

/** What the browser keeps between visits; null where it keeps nothing. */
export function localStore(): Storage | null {
  try {
    return localStorage;
  } catch {
    return null;
  }
}
