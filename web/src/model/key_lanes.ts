/**
 * The keys of a shot as the timeline shows them: a lane for each focus point and for each setting of the camera that has keys.
 * The keys of a lane that stand at one time are a *stack*: they are selected, moved and removed as one.
 */

import { isAllowed } from "./allowed";
import { FAR_AWAY_M, type Changes } from "./changes";
import type { Interpolation, Key, Keyed, KeyedSetting, Tangents } from "./keys";
import {
  EXPOSURE_SLIDERS,
  FILM_SLIDERS,
  FOCUS_SLIDERS,
  LENS_SLIDERS,
  POINT_SLIDERS,
  type Declared,
  type SliderRange,
} from "./settings.gen";
import { KEYED_ATTRIBUTES, keysOf, type FocusMode, type FocusPoint, type KeyedAttribute } from "./shot";
import { nearestTime, sameTime, type FrameRange } from "./time";

/** What has a key with a value: an attribute of a focus point, or a setting of the camera. */
export type ValueOwner =
  { readonly point: string; readonly attribute: KeyedAttribute } | { readonly setting: KeyedSetting };

/** What has a key: a value, or the place of the camera. */
export type KeyOwner = ValueOwner | { readonly place: "camera" };

/** The place of the camera, whose keys have times alone: as a value, 1 is a key of the edits and 0 one of the shot. */
export const CAMERA_PLACE: KeyOwner = { place: "camera" };

export interface OwnedKey {
  readonly owner: KeyOwner;
  readonly key: Key;
}

export interface ValueKey extends OwnedKey {
  readonly owner: ValueOwner;
}

export interface KeyStack {
  readonly id: string;
  /** Id of its lane. */
  readonly lane: string;
  /** USD time code. */
  readonly time: number;
  readonly keys: readonly OwnedKey[];
}

export interface KeyLane {
  readonly id: string;
  readonly label: string;
  /** Name of the focus point; null for a setting of the camera. */
  readonly point: string | null;
  /** In the order of time. */
  readonly stacks: readonly KeyStack[];
}

/** Changes in one edit, as the service takes them. */
export const MOST_CHANGES = 1024;

const DECLARED: Readonly<Record<string, Declared>> = {
  ...FILM_SLIDERS,
  ...EXPOSURE_SLIDERS,
  ...FOCUS_SLIDERS,
  ...LENS_SLIDERS,
};
const DECLARED_OF_POINTS: Readonly<Record<string, Declared>> = POINT_SLIDERS;

/** The lanes of what has keys: the camera's settings first, as `keyed` lists them, then the focus points, and its place. */
export function lanesOf(keyed: readonly Keyed[], points: readonly FocusPoint[], place: readonly Key[] = []): KeyLane[] {
  const settings = keyed.flatMap((keys) => Object.entries(keys)).filter(([, keys]) => keys.length > 0);
  const placed = place.map((key) => ({ owner: CAMERA_PLACE, key }));
  return [
    ...settings.map(([name, keys]): KeyLane => {
      const owner: KeyOwner = { setting: name as KeyedSetting };
      return lane(
        laneOf(owner),
        labelOf(owner),
        null,
        keys.map((key) => ({ owner, key })),
      );
    }),
    ...points.flatMap((point): KeyLane[] => {
      const keys = KEYED_ATTRIBUTES.flatMap((attribute) =>
        keysOf(point, attribute).map((key): OwnedKey => ({ owner: { point: point.name, attribute }, key })),
      );
      return keys.length > 0 ? [lane(`point ${point.name}`, point.name, point.name, keys)] : [];
    }),
    ...(placed.length > 0 ? [lane(laneOf(CAMERA_PLACE), labelOf(CAMERA_PLACE), null, placed)] : []),
  ];
}

/** The id of the lane that has the keys of a setting or attribute. */
export function laneOf(owner: KeyOwner): string {
  if ("point" in owner) return `point ${owner.point}`;
  return `camera ${"setting" in owner ? owner.setting : "place"}`;
}

function lane(id: string, label: string, point: string | null, keys: readonly OwnedKey[]): KeyLane {
  const stacks: { time: number; keys: OwnedKey[] }[] = [];
  for (const owned of keys.toSorted((a, b) => a.key.time - b.key.time)) {
    const last = stacks.at(-1);
    if (last && sameTime(last.time, owned.key.time)) last.keys.push(owned);
    else stacks.push({ time: owned.key.time, keys: [owned] });
  }
  return { id, label, point, stacks: stacks.map((stack) => ({ ...stack, id: stackId(id, stack.time), lane: id })) };
}

/** The id of the stack of a lane at a time. */
export function stackId(lane: string, time: number): string {
  return `${lane}@${Number(time.toFixed(4)).toString()}`;
}

/** The name of a setting or attribute for people. */
export function labelOf(owner: KeyOwner): string {
  if ("place" in owner) return "Camera";
  return declaredOf(owner)?.label ?? inWords("setting" in owner ? owner.setting : owner.attribute);
}

/** The slider of a setting or attribute; null where it has none. */
export function sliderOf(owner: KeyOwner): SliderRange | null {
  return declaredOf(owner)?.slider ?? null;
}

/** Whether a setting or attribute may have a value. */
export function mayBe(owner: KeyOwner, value: number): boolean {
  const declared = declaredOf(owner);
  // One far away stands for infinity.
  const sent = "setting" in owner && owner.setting === "focusDistanceM" ? Math.min(value, FAR_AWAY_M) : value;
  return declared === undefined || isAllowed(declared.allowed, sent);
}

/** A value within what a setting or attribute may have. */
export function heldIn(owner: KeyOwner, value: number): number {
  const { least = -Infinity, most = Infinity } = declaredOf(owner)?.allowed ?? {};
  return Math.min(Math.max(value, least), most);
}

function declaredOf(owner: KeyOwner): Declared | undefined {
  if ("place" in owner) return undefined;
  return "setting" in owner ? DECLARED[owner.setting] : DECLARED_OF_POINTS[owner.attribute];
}

function inWords(name: string): string {
  const words = name.replace(/(Mm|M|S|K|E|Deg|DegS|Um)$/, "").replace(/[A-Z]/g, (letter) => ` ${letter.toLowerCase()}`);
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** Whether keys of it shape no curve: it is on or off, or a place. */
export function isPlain(owner: KeyOwner): boolean {
  if ("place" in owner) return true;
  return "setting" in owner
    ? owner.setting === "solveStop" || owner.setting === "drivenByPoints"
    : owner.attribute === "enabled";
}

/**
 * Puts keys in place of others, one for one. Other keys that stand where one of them arrives are replaced.
 *
 * @param before stacks as they are.
 * @param after the same stacks with their keys moved or changed.
 * @param mode of the focus, which a key of the camera's own distance would change.
 */
export function replaceStacks(before: readonly KeyStack[], after: readonly KeyStack[], mode: FocusMode): Changes {
  const [old, wanted] = [before.flatMap(({ keys }) => keys), after.flatMap(({ keys }) => keys)];
  const pairs = old.flatMap((from, place) => {
    const to = wanted[place];
    return to && !isSameKey(from.key, to.key) ? [{ from, to }] : [];
  });
  const moved = pairs.filter(({ from, to }) => from.key.time !== to.key.time);
  const removed = moved.flatMap(({ from }) => ("place" in from.owner ? [] : [remove(from)]));
  const set = pairs.flatMap(({ to: { owner, key } }) => ("place" in owner ? [] : [setKey(owner, key)]));
  return keepMode(
    [...removed, ...set, ...moveCameraKeys(moved)],
    pairs.map(({ to: { owner } }) => owner),
    mode,
  );
}

/** Keys of the camera's place are moved all at once. */
function moveCameraKeys(moved: readonly { readonly from: OwnedKey; readonly to: OwnedKey }[]): Changes {
  const moves = moved
    .filter(({ from }) => "place" in from.owner)
    .map(({ from, to }) => ({ time: from.key.time, newTime: to.key.time }));
  return moves.length > 0 ? [{ type: "moveCameraKeys", moves }] : [];
}

/** Adds what keeps the focus mode: with a key of its own distance, a camera is focused by hand. */
export function keepMode(changes: Changes, owners: readonly KeyOwner[], mode: FocusMode): Changes {
  const isByHand = owners.some((owner) => "setting" in owner && owner.setting === "focusDistanceM");
  return isByHand && mode !== "manual" ? [...changes, { type: "setFocus", values: { mode } }] : changes;
}

export function isSameOwner(a: KeyOwner, b: KeyOwner): boolean {
  if ("place" in a) return "place" in b;
  if ("setting" in a) return "setting" in b && a.setting === b.setting;
  return "point" in b && a.point === b.point && a.attribute === b.attribute;
}

function isSameKey(a: Key, b: Key): boolean {
  const isSame = a.time === b.time && a.value === b.value && a.interpolation === b.interpolation;
  return isSame && JSON.stringify(a.tangents ?? null) === JSON.stringify(b.tangents ?? null);
}

/** A stack at another time, so many time codes later. */
export function movedStack({ lane, time, keys }: KeyStack, by: number): KeyStack {
  const later = (at: number): number => Number((at + by).toFixed(6));
  const moved = keys.map(({ owner, key }) => ({ owner, key: { ...key, time: later(key.time) } }));
  return { id: stackId(lane, later(time)), lane, time: later(time), keys: moved };
}

/**
 * Stacks whose times are stretched from the first one on, with their handles.
 *
 * @param factor above 0.
 */
export function stretched(stacks: readonly KeyStack[], factor: number): KeyStack[] {
  const first = Math.min(...stacks.map(({ time }) => time));
  return stacks.map((stack) =>
    retimed(
      stack,
      first + (stack.time - first) * factor,
      ({ inSlope = 0, inWidth = 0, outSlope = 0, outWidth = 0 }) => ({
        inSlope: inSlope / factor,
        inWidth: inWidth * factor,
        outSlope: outSlope / factor,
        outWidth: outWidth * factor,
      }),
    ),
  );
}

/**
 * Stacks in the opposite order of time: the first one comes where the last was. Each key goes on to the next in the way in which the
 * curve came to it.
 */
export function mirrored(stacks: readonly KeyStack[]): KeyStack[] {
  const times = stacks.map(({ time }) => time);
  const sum = Math.min(...times) + Math.max(...times);
  const all = stacks.flatMap(({ keys }) => keys);
  return stacks.map((stack) => {
    const turned = retimed(stack, sum - stack.time, ({ inSlope = 0, inWidth = 0, outSlope = 0, outWidth = 0 }) => ({
      inSlope: -outSlope,
      inWidth: outWidth,
      outSlope: -inSlope,
      outWidth: inWidth,
    }));
    const keys = turned.keys.map(({ owner, key }, place) => {
      const own = all.filter((other) => isSameOwner(other.owner, owner)).toSorted((a, b) => a.key.time - b.key.time);
      const index = own.findIndex((other) => other.key === stack.keys[place]?.key);
      const before = own.at(index - 1); // the last one for the first
      return before && before.key.interpolation !== key.interpolation
        ? { owner, key: { time: key.time, value: key.value, interpolation: before.key.interpolation } }
        : { owner, key };
    });
    return { ...turned, keys };
  });
}

function retimed(stack: KeyStack, time: number, turn: (tangents: Tangents) => Tangents): KeyStack {
  const at = Number(time.toFixed(4));
  const keys = stack.keys.map(({ owner, key }) => ({
    owner,
    key: { ...key, time: at, ...(key.tangents && { tangents: turn(key.tangents) }) },
  }));
  return { id: stackId(stack.lane, at), lane: stack.lane, time: at, keys };
}

/** Time of the first of stacks. */
export function firstTime(stacks: readonly KeyStack[]): number {
  return Math.min(...stacks.map(({ time }) => time));
}

/** Time from the first of stacks to the last, time codes; 0 for none. */
export function lengthOf(stacks: readonly KeyStack[]): number {
  const times = stacks.map(({ time }) => time);
  return times.length > 0 ? Math.max(...times) - Math.min(...times) : 0;
}

/** Whether a key has a value, which can be copied. */
export function hasValue(owned: OwnedKey): owned is ValueKey {
  return !("place" in owned.owner);
}

/** Sets copies of keys, the first of which comes to a time. */
export function pasteKeys(keys: readonly ValueKey[], time: number, mode: FocusMode): Changes {
  const by = time - Math.min(...keys.map(({ key }) => key.time));
  return keepMode(
    keys.map(({ owner, key }) => setKey(owner, { ...key, time: Number((key.time + by).toFixed(4)) })),
    keys.map(({ owner }) => owner),
    mode,
  );
}

/** Removes all keys of stacks. */
export function removeStacks(stacks: readonly KeyStack[]): Changes {
  return stacks.flatMap((stack) => stack.keys).map(remove);
}

/** How a curve goes through a key: its interpolation, or with level handles. */
export type KeyShape = Interpolation | "flat";

const LEVEL: Tangents = { inSlope: 0, inWidth: 0, outSlope: 0, outWidth: 0 };

/** A key of another shape; the same one where it has it already, or is a switch's. */
export function shaped(owned: OwnedKey, shape: KeyShape): OwnedKey {
  const { owner, key } = owned;
  const now = shapeOf(key);
  if (isPlain(owner) || now === shape || (shape === "bezier" && key.interpolation === "bezier")) return owned;
  if (shape === "flat") return withTangents(owned, LEVEL);
  return { owner, key: { time: key.time, value: key.value, interpolation: shape } };
}

/** A key with handles of its own. */
export function withTangents({ owner, key: { time, value } }: OwnedKey, tangents: Tangents): OwnedKey {
  return { owner, key: { time, value, interpolation: "bezier", tangents } };
}

function shapeOf({ interpolation, tangents }: Key): KeyShape {
  return interpolation === "bezier" && tangents?.inSlope === 0 && tangents.outSlope === 0 ? "flat" : interpolation;
}

/** Stacks with a change of each of their keys. */
export function mapKeys(stacks: readonly KeyStack[], change: (owned: OwnedKey) => OwnedKey): KeyStack[] {
  return stacks.map((stack) => ({ ...stack, keys: stack.keys.map(change) }));
}

/** A key with another value; one far away stands for infinity. */
export function valued({ owner, key }: OwnedKey, value: number): OwnedKey {
  return { owner, key: { ...key, value: Math.min(value, FAR_AWAY_M) } };
}

/** The change that sets a key, or adds it. */
export function setKey(owner: ValueOwner, key: Key): Changes[number] {
  return "setting" in owner
    ? { type: "keySetting", setting: owner.setting, key }
    : { type: "keyPoint", name: owner.point, attribute: owner.attribute, key };
}

function remove({ owner, key: { time } }: OwnedKey): Changes[number] {
  if ("place" in owner) return { type: "unkeyCamera", time };
  return "setting" in owner
    ? { type: "unkeySetting", setting: owner.setting, time }
    : { type: "unkeyPoint", name: owner.point, attribute: owner.attribute, time };
}

/**
 * How far a key goes that is dragged: to a time to snap to, where one is near, else to a whole frame.
 *
 * @param from time of the key.
 * @param by how far it is dragged.
 * @param targets times to snap to, such as the playhead's and those of other keys.
 * @param reach how near a target must be, time codes; half a frame at most, so that each frame can be reached.
 */
export function snapShift(
  range: FrameRange,
  from: number,
  by: number,
  targets: readonly number[],
  reach: number,
): number {
  const wanted = from + holdShift(range, from, by);
  const near = targets.filter((time) => Math.abs(time - wanted) <= Math.min(reach, 0.5) && !sameTime(time, from));
  const last = wanted > range.end ? Infinity : Math.floor(range.end - range.start + 1e-6);
  const frame = range.start + Math.min(Math.round(wanted - range.start), last);
  return (nearestTime(near, wanted) ?? frame) - from;
}

/** How far keys go together that are to go so far: all of them stay in the shot, or come no farther out of it. */
export function holdAll(range: FrameRange, stacks: readonly KeyStack[], by: number): number {
  const times = stacks.map(({ time }) => time);
  const [least, most] = [Math.min(0, range.start - Math.min(...times)), Math.max(0, range.end - Math.max(...times))];
  return Math.min(Math.max(by, least), most);
}

/** How far a key goes that is to go so far: it stays in the shot, or comes no farther out of it. */
function holdShift(range: FrameRange, from: number, by: number): number {
  return Math.min(Math.max(from + by, Math.min(range.start, from)), Math.max(range.end, from)) - from;
}

/** The shape that all keys of stacks have; null where they differ or hold by themselves. */
export function shapeOfAll(stacks: readonly KeyStack[]): KeyShape | null {
  const found = new Set(
    stacks
      .flatMap((stack) => stack.keys)
      .filter(({ owner }) => !isPlain(owner))
      .map(({ key }) => shapeOf(key)),
  );
  const [only = null] = found;
  return found.size === 1 ? only : null;
}

/** Keys of a setting from which on they can be made fewer. */
const MANY = 3;

/** The setting that stacks are all keys of; null where they are few, not all of one, or a switch's. */
export function wholeSetting(stacks: readonly KeyStack[], lanes: readonly KeyLane[]): KeyedSetting | null {
  const owned = stacks.flatMap(({ keys }) => keys);
  const [first] = owned;
  if (owned.length < MANY || !first || !("setting" in first.owner) || isPlain(first.owner)) return null;
  const { owner } = first;
  const isAll = lanes.find(({ id }) => id === laneOf(owner))?.stacks.length === owned.length;
  return isAll && owned.every((key) => isSameOwner(key.owner, owner)) ? owner.setting : null;
}
