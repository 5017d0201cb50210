/** Everything that can be asked of the service to change a shot, as data; an edit is a row of these. */

import type { Curve } from "./curve";
import type { ExposureChange, ExposureSettings, FilmChange, FilmSettings, Keyed } from "./photography";
import {
  keysOf,
  type Anchor,
  type FocusMode,
  type FocusPoint,
  type FocusSettings,
  type Key,
  type KeyedAttribute,
  type Lens,
  type PointSettings,
  type Rack,
  type Readout,
} from "./shot";
import { sameTime } from "./time";

export type FocusChange = Partial<Omit<FocusSettings, "keys">>;
export type PointChange = Partial<PointSettings & { readonly anchor: Anchor }>;

export type Command =
  /** With a time it sets a key there, without it holds for the whole shot. */
  | { readonly do: "setLens"; readonly change: Partial<Lens>; readonly time: number | null }
  /** As `setLens`. */
  | { readonly do: "setFocus"; readonly change: FocusChange; readonly time: number | null }
  | { readonly do: "rack"; readonly rack: Rack }
  | { readonly do: "addPoint"; readonly name: string; readonly anchor: Anchor }
  | { readonly do: "changePoint"; readonly name: string; readonly change: PointChange }
  | { readonly do: "removePoint"; readonly name: string }
  | { readonly do: "setKey"; readonly name: string; readonly attribute: KeyedAttribute; readonly key: Key }
  | { readonly do: "removeKey"; readonly name: string; readonly attribute: KeyedAttribute; readonly time: number }
  /** A lens of the library by its name, or null for the thin lens. */
  | { readonly do: "mountLens"; readonly lens: string | null }
  | { readonly do: "mountLensFile"; readonly file: File }
  /** As `setLens`. */
  | { readonly do: "setExposure"; readonly change: ExposureChange; readonly time: number | null }
  /** As `setLens`; a stock goes in for the whole shot. */
  | { readonly do: "setFilm"; readonly change: FilmChange; readonly time: number | null }
  /** A body of the library by its name. */
  | { readonly do: "mountBody"; readonly body: string }
  | { readonly do: "importCurve"; readonly file: File }
  /** A key of how the focus is found, of the exposure or of the film; null removes the one at the time. */
  | {
      readonly do: "keySetting";
      readonly of: SettingsKind;
      readonly setting: string;
      readonly time: number;
      readonly key: Key | null;
    };

/** What can be tried in a picture without saving it: a command, or a point put on what is seen at a place, 0 to 1. */
export type Trial = Command | { readonly do: "place"; readonly name: string; readonly at: readonly [number, number] };

/** What has settings that take keys. */
export type SettingsKind = "focus" | "exposure" | "film";

/** An edit, done from the first to the last; all of it is one step of undo. */
export type Change = readonly Command[];

/** The attributes that the page sets by themselves, and what they are called among a point's settings. */
const SETTINGS = {
  weight: "weight",
  enabled: "enabled",
  blur: "blurMm",
  falloff: "falloff",
  extent: "extent",
} as const;
export type SimpleAttribute = keyof typeof SETTINGS;

/** What an attribute is at the point's time; a switch is 0 or 1. */
export function valueOf(point: FocusPoint, attribute: SimpleAttribute): number {
  return Number(point.settings[SETTINGS[attribute]]);
}

/** The key of an attribute at a time. */
export function keyAt(point: FocusPoint, attribute: KeyedAttribute, time: number): Key | null {
  return keysOf(point, attribute).find((key) => sameTime(key.time, time)) ?? null;
}

/** Sets an attribute: what is keyed gets a key at the time; what is not changes for the whole shot, as animators expect. */
export function setAttribute(point: FocusPoint, attribute: SimpleAttribute, value: number, time: number): Change {
  if (keysOf(point, attribute).length > 0) return setKey(point, attribute, value, time);
  const change: PointChange = { [SETTINGS[attribute]]: attribute === "enabled" ? value > 0 : value };
  return [{ do: "changePoint", name: point.name, change }];
}

/** Sets one key; one that is there keeps its interpolation. */
export function setKey(point: FocusPoint, attribute: KeyedAttribute, value: number, time: number): Change {
  const standard = attribute === "enabled" ? "held" : "auto";
  const interpolation = keyAt(point, attribute, time)?.interpolation ?? standard;
  return [{ do: "setKey", name: point.name, attribute, key: { time, value, interpolation } }];
}

/** Removes a key if there is one at the time, else sets one with the value that the attribute has there. */
export function toggleKey(point: FocusPoint, attribute: SimpleAttribute, time: number): Change {
  const key = keyAt(point, attribute, time);
  return key
    ? [{ do: "removeKey", name: point.name, attribute, time: key.time }]
    : setKey(point, attribute, valueOf(point, attribute), time);
}

/** Sets the lens: a key at the time for what is animated, else for the whole shot. */
export function setLens(name: keyof Lens, value: number, time: number, before: Readout, curve: Curve): Change {
  return [{ do: "setLens", change: { [name]: value }, time: isAnimated(name, before, curve) ? time : null }];
}

/** Whether the camera itself moves over the shot; where points decide the focus, its own is not seen. */
function isAnimated(name: keyof Lens, before: Readout, curve: Curve): boolean {
  if (name === "focusDistanceM" && before.source === "points") return false;
  return curve.some((sample) => sample[name] !== curve[0]?.[name]);
}

/** Says who focuses. */
export function setFocusMode(mode: FocusMode, before: FocusMode): Change {
  return mode === before ? [] : [{ do: "setFocus", change: { mode }, time: null }];
}

/** Sets one thing of how the focus is found: what is keyed gets a key at the time, else it holds for the whole shot. */
export function setFocus(change: FocusChange, time: number, before: FocusSettings): Change {
  return [{ do: "setFocus", change, time: isKeyed(change, before.keys) ? time : null }];
}

/** As `setFocus`. */
export function setExposure(change: ExposureChange, time: number, before: ExposureSettings): Change {
  return [{ do: "setExposure", change, time: isKeyed(change, before.keys) ? time : null }];
}

/** As `setFocus`. */
export function setFilm(change: FilmChange, time: number, before: FilmSettings): Change {
  return [{ do: "setFilm", change, time: isKeyed(change, before.keys) ? time : null }];
}

/** A shutter that is set by its angle has its keys where it closes. */
function isKeyed(change: object, keys: Keyed): boolean {
  return Object.keys(change).some(
    (name) => (keys[name === "shutterAngleDeg" ? "shutterClose" : name] ?? []).length > 0,
  );
}

/** The key of a setting at a time. */
export function settingKeyAt(keys: Keyed, setting: string, time: number): Key | null {
  return keys[setting]?.find((key) => sameTime(key.time, time)) ?? null;
}

/** What stands for infinity among the keys of a distance: a curve through infinity has no middle. */
const FAR_AWAY_M = 100_000;

/** Removes the key of a setting if there is one at the time, else sets one with the value that it has there. */
export function toggleSettingKey(of: SettingsKind, setting: string, value: number, time: number, keys: Keyed): Change {
  const there = settingKeyAt(keys, setting, time);
  const isSwitch = setting === "solveStop" || setting === "drivenByPoints";
  const key: Key = { time, value: Math.min(value, FAR_AWAY_M), interpolation: isSwitch ? "held" : "auto" };
  return [{ do: "keySetting", of, setting, time: there?.time ?? time, key: there ? null : key }];
}

/** Blur of a point that becomes soft and has none: enough to be seen. */
const FIRST_BLUR_MM = 0.1;

/** Makes a point sharp or soft. */
export function setKind(point: FocusPoint, kind: PointSettings["kind"]): Change {
  const needsBlur = kind === "soft" && point.settings.blurMm === 0 && point.settings.surfaceOffset === 0;
  const blur = needsBlur && keysOf(point, "blur").length === 0 ? { blurMm: FIRST_BLUR_MM } : {};
  return [{ do: "changePoint", name: point.name, change: { kind, ...blur } }];
}
