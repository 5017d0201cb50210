/**
 * The edit language as the page speaks it. A `Change` is the service's own model (`service/models/changes.py`); an edit is a list
 * of changes, and so is what a hand tries in the picture. The functions here make the changes of each gesture.
 */

import type { components } from "../net/schema";
import type { Curve } from "./curve";
import type { Key, Keyed, KeyedSetting } from "./keys";
import type { ExposureChange, ExposureSettings, FilmChange, FilmSettings } from "./photography";
import { weightOf, type Weight } from "./pull";
import {
  keysOf,
  type Anchor,
  type FocusMode,
  type FocusPoint,
  type FocusSettings,
  type KeyedAttribute,
  type Lens,
  type PointSettings,
  type Readout,
} from "./shot";
import { sameTime } from "./time";
import type { Vector } from "./vector";

type Json = components["schemas"];

/** Changes of one edit, applied from the first to the last, all of them or none. */
export type Changes = Json["EditRequest"]["changes"];
export type Change = Changes[number];

export type FocusChange = Partial<Omit<FocusSettings, "keys">>;

/** The attributes that the page sets by themselves, and their names among a point's settings. */
const SETTINGS = {
  weight: "weight",
  enabled: "enabled",
  blur: "blurMm",
  falloff: "falloff",
  extent: "extent",
} as const;
export type SimpleAttribute = keyof typeof SETTINGS;

/** The value of an attribute at the point's time; a switch is 0 or 1. */
export function valueOf(point: FocusPoint, attribute: SimpleAttribute): number {
  return Number(point.settings[SETTINGS[attribute]]);
}

/** The key of an attribute at a time. */
export function keyAt(point: FocusPoint, attribute: KeyedAttribute, time: number): Key | null {
  return keysOf(point, attribute).find((key) => sameTime(key.time, time)) ?? null;
}

/** Sets an attribute: with keys it gets one at the time, without it changes for the whole shot, as animators expect. */
export function setAttribute(point: FocusPoint, attribute: SimpleAttribute, value: number, time: number): Changes {
  if (keysOf(point, attribute).length > 0) return setKey(point, attribute, value, time);
  const values = { [SETTINGS[attribute]]: attribute === "enabled" ? value > 0 : value };
  return [{ type: "alterPoint", name: point.name, values, time }];
}

/** Sets one key; one that is there keeps its interpolation. */
export function setKey(point: FocusPoint, attribute: KeyedAttribute, value: number, time: number): Changes {
  const standard = attribute === "enabled" ? "held" : "auto";
  const interpolation = keyAt(point, attribute, time)?.interpolation ?? standard;
  return [{ type: "keyPoint", name: point.name, attribute, key: { time, value, interpolation } }];
}

/**
 * Makes the weights of points what they are to be. Those that are not named, and were changed since, go back to what they were.
 *
 * @param weights by the names of points.
 * @param before the points that they were made of; a point that is not among them is new, and has weight 1.
 * @param now the points as they are.
 * @param time of the points.
 */
export function setWeights(
  weights: ReadonlyMap<string, Weight>,
  before: readonly FocusPoint[],
  now: readonly FocusPoint[],
  time: number,
): Changes {
  const all = new Map([...before.map((point): [string, Weight] => [point.name, weightOf(point)]), ...weights]);
  return [...all].flatMap(([name, weight]) => {
    const point = now.find((one) => one.name === name);
    return setWeight(name, point ? weightOf(point) : { keys: [], value: 1 }, weight, time);
  });
}

function setWeight(name: string, now: Weight, { keys, value }: Weight, time: number): Changes {
  const attribute = "weight" as const;
  const set = keys.filter((key) => !now.keys.some((old) => isSameKey(old, key)));
  const gone = now.keys.filter((old) => !keys.some((key) => sameTime(key.time, old.time)));
  const isAltered = keys.length === 0 && (now.keys.length > 0 || now.value !== value);
  // Handles are cut short by keys that are beside them as they are set.
  return [
    ...gone.map((key): Change => ({ type: "unkeyPoint", name, attribute, time: key.time })),
    ...set.map((key): Change => ({ type: "keyPoint", name, attribute, key })),
    ...(isAltered ? [{ type: "alterPoint", name, values: { weight: value }, time } as const] : []),
  ];
}

function isSameKey(one: Key, other: Key): boolean {
  const [own, others] = [one.tangents, other.tangents];
  const isShaped = own?.inSlope === others?.inSlope && own?.outSlope === others?.outSlope;
  const isWide = own?.inWidth === others?.inWidth && own?.outWidth === others?.outWidth;
  const isPlaced = sameTime(one.time, other.time) && one.value === other.value;
  return isPlaced && one.interpolation === other.interpolation && isShaped && isWide;
}

/** Removes a key if there is one at the time, else sets one with the value that the attribute has there. */
export function toggleKey(point: FocusPoint, attribute: SimpleAttribute, time: number): Changes {
  const key = keyAt(point, attribute, time);
  return key
    ? [{ type: "unkeyPoint", name: point.name, attribute, time: key.time }]
    : setKey(point, attribute, valueOf(point, attribute), time);
}

/** Moves a point onto a surface: an offset from it, which it has where it was moved from above, is dropped. */
export function moveOnto(
  { name, settings }: Pick<FocusPoint, "name" | "settings">,
  to: { readonly anchor: Anchor } | { readonly place: readonly [number, number] },
  time: number,
): Changes {
  const isOff = settings.offset.some((along) => along !== 0);
  const onto: Changes = isOff ? [{ type: "alterPoint", name, values: { offset: [0, 0, 0] }, time }] : [];
  return [...onto, { type: "movePoint", name, ...to, time }];
}

/** Moves a point to a place of the world; it stays with what it is on. */
export function moveInWorld(name: string, positionM: Vector, time: number): Changes {
  return [{ type: "movePoint", name, positionM, time }];
}

/**
 * Sets the lens: a key at the time for what is animated, else for the whole shot.
 *
 * @param keys of the lens, and of settings that this does not change.
 */
export function setLens(
  name: keyof Lens,
  value: number,
  time: number,
  before: Readout,
  curve: Curve,
  keys: Keyed,
): Changes {
  // USD and the service write infinity as 0.
  const values = { [name]: value === Infinity ? 0 : value };
  const animated = isAnimated(name, before, curve) ? { time } : keyTime(values, time, keys);
  return [{ type: "setCamera", values: { ...values, ...animated } }];
}

/** Whether the camera itself changes over the shot; where points decide the focus, its own distance is not seen. */
function isAnimated(name: keyof Lens, before: Readout, curve: Curve): boolean {
  if (name === "focusDistanceM" && before.source === "points") return false;
  return curve.some((sample) => sample[name] !== curve[0]?.[name]);
}

/** Sets who focuses. */
export function setFocusMode(mode: FocusMode, before: FocusMode): Changes {
  return mode === before ? [] : [{ type: "setFocus", values: { mode } }];
}

/** Sets focus settings: keyed ones get a key at the time, others hold for the whole shot. */
export function setFocus(values: FocusChange, time: number, before: FocusSettings): Changes {
  return [{ type: "setFocus", values: { ...values, ...keyTime(values, time, before.keys) } }];
}

/** As `setFocus`. */
export function setExposure(values: ExposureChange, time: number, before: ExposureSettings): Changes {
  return [{ type: "setExposure", values: { ...values, ...keyTime(values, time, before.keys) } }];
}

/** As `setFocus`; a stock goes in for the whole shot. */
export function setFilm(values: FilmChange, time: number, before: FilmSettings): Changes {
  return [{ type: "setFilm", values: { ...values, ...keyTime(values, time, before.keys) } }];
}

/** The time of keys, where one of the settings has any. A shutter that is set by its angle has its keys where it closes. */
function keyTime(values: object, time: number, keys: Keyed): { time?: number } {
  const isKeyed = Object.keys(values).some(
    (name) => (keys[name === "shutterAngleDeg" ? "shutterClose" : name] ?? []).length > 0,
  );
  return isKeyed ? { time } : {};
}

/** The key of a setting at a time. */
export function settingKeyAt(keys: Keyed, setting: string, time: number): Key | null {
  return keys[setting]?.find((key) => sameTime(key.time, time)) ?? null;
}

/** Stands for infinity among the keys of a distance: a curve through infinity has no middle. */
export const FAR_AWAY_M = 100_000;

/** Removes the key of a setting if there is one at the time, else sets one with the value that it has there. */
export function toggleSettingKey(setting: KeyedSetting, value: number, time: number, keys: Keyed): Changes {
  const present = settingKeyAt(keys, setting, time);
  if (present) return [{ type: "unkeySetting", setting, time: present.time }];
  const isSwitch = setting === "solveStop" || setting === "drivenByPoints";
  const key: Key = { time, value: Math.min(value, FAR_AWAY_M), interpolation: isSwitch ? "held" : "auto" };
  return [{ type: "keySetting", setting, key }];
}

/** Blur of a point that becomes soft and has none: enough to be seen. */
const FIRST_BLUR_MM = 0.1;

/** Makes a point sharp or soft. */
export function setKind(point: FocusPoint, kind: PointSettings["kind"], time: number): Changes {
  const needsBlur = kind === "soft" && point.settings.blurMm === 0 && point.settings.surfaceOffset === 0;
  const blur = needsBlur && keysOf(point, "blur").length === 0 ? { blurMm: FIRST_BLUR_MM } : {};
  return [{ type: "alterPoint", name: point.name, values: { kind, ...blur }, time }];
}
