/** Everything that can be asked of the service to change a shot, as data; edits are made of these. */

import type { Curve } from "./curve";
import type { Edit } from "./history";
import {
  KEYED_ATTRIBUTES,
  keysOf,
  type Anchor,
  type FocusMode,
  type FocusPoint,
  type Key,
  type KeyedAttribute,
  type Lens,
  type PointSettings,
  type Readout,
} from "./shot";
import { sameTime } from "./time";

export type LensChange = Partial<Lens & { readonly focusMode: FocusMode }>;
export type PointChange = Partial<PointSettings & { readonly anchor: Anchor }>;

export type Command =
  /** With a time it sets a key there, without it holds for the whole shot. */
  | { readonly do: "setLens"; readonly change: LensChange; readonly time: number | null }
  | {
      readonly do: "addPoint";
      readonly name: string;
      readonly anchor: Anchor;
      readonly settings: Partial<PointSettings>;
    }
  | { readonly do: "changePoint"; readonly name: string; readonly change: PointChange }
  | { readonly do: "removePoint"; readonly name: string }
  | { readonly do: "setKey"; readonly name: string; readonly attribute: KeyedAttribute; readonly key: Key }
  | { readonly do: "removeKey"; readonly name: string; readonly attribute: KeyedAttribute; readonly time: number }
  /** A lens of the library by its name, or null for the thin lens. */
  | { readonly do: "mountLens"; readonly lens: string | null }
  | { readonly do: "mountLensFile"; readonly file: File }
  /** Takes back every edit since a revision of the shot. */
  | { readonly do: "restoreEdits"; readonly revision: string };

export type ShotEdit = Edit<Command>;

/** The attributes that the page sets by itself. */
export type SimpleAttribute = "weight" | "enabled";

/** The key of an attribute at a time. */
export function keyAt(point: FocusPoint, attribute: KeyedAttribute, time: number): Key | null {
  return keysOf(point, attribute).find((key) => sameTime(key.time, time)) ?? null;
}

/**
 * The commands that set a keyed attribute at a time, and those that take it back.
 *
 * What is keyed gets a key at the time; what is not is changed for the whole shot, as animators expect.
 */
export function setAttribute(point: FocusPoint, attribute: SimpleAttribute, value: number, time: number): Change {
  if (keysOf(point, attribute).length > 0) return setKey(point, attribute, value, time);
  const settings = (to: number): PointChange => (attribute === "weight" ? { weight: to } : { enabled: to > 0 });
  return {
    redo: [{ do: "changePoint", name: point.name, change: settings(value) }],
    undo: [{ do: "changePoint", name: point.name, change: settings(Number(point.settings[attribute])) }],
  };
}

/** The commands of an edit, both ways. */
export type Change = Omit<ShotEdit, "label">;

/** Sets one key; undone, what was there before is there again. */
export function setKey(point: FocusPoint, attribute: KeyedAttribute, value: number, time: number): Change {
  const { name } = point;
  const before = keyAt(point, attribute, time);
  const interpolation = before?.interpolation ?? (attribute === "enabled" ? "held" : "auto");
  return {
    redo: [{ do: "setKey", name, attribute, key: { time, value, interpolation } }],
    undo: [before ? { do: "setKey", name, attribute, key: before } : { do: "removeKey", name, attribute, time }],
  };
}

/** Removes a key if there is one at the time, else sets one with the value that the attribute has there. */
export function toggleKey(point: FocusPoint, attribute: SimpleAttribute, time: number): Change {
  const key = keyAt(point, attribute, time);
  if (!key) return setKey(point, attribute, Number(point.settings[attribute]), time);
  return {
    redo: [{ do: "removeKey", name: point.name, attribute, time: key.time }],
    undo: [{ do: "setKey", name: point.name, attribute, key }],
  };
}

/** Removes a focus point; undone, it is there again with its keys. */
export function removePoint(point: FocusPoint): Change {
  const { name, anchor, settings } = point;
  const keys = KEYED_ATTRIBUTES.flatMap((attribute) =>
    keysOf(point, attribute).map((key): Command => ({ do: "setKey", name, attribute, key })),
  );
  return {
    redo: [{ do: "removePoint", name }],
    undo: [{ do: "addPoint", name, anchor, settings }, ...keys],
  };
}

/**
 * Sets the lens: a key at the time for what is animated, else for the whole shot.
 *
 * A hand on the focus ring takes the focus from the points, so undoing it gives it back to them.
 */
export function setLens(name: keyof Lens, value: number, time: number, before: Readout, curve: Curve): Change {
  const at = isAnimated(name, before, curve) ? time : null;
  const mode: LensChange = name === "focusDistanceM" ? { focusMode: before.focusMode } : {};
  return {
    redo: [{ do: "setLens", change: { [name]: value }, time: at }],
    undo: [{ do: "setLens", change: { [name]: before[name], ...mode }, time: at }],
  };
}

/** Whether the camera itself moves over the shot; where points decide the focus, its own is not seen. */
function isAnimated(name: keyof Lens, before: Readout, curve: Curve): boolean {
  if (name === "focusDistanceM" && before.source === "points") return false;
  return curve.some((sample) => sample[name] !== curve[0]?.[name]);
}

/** Says who focuses. */
export function setFocusMode(mode: FocusMode, before: FocusMode): Change {
  if (mode === before) return NO_CHANGE;
  const set = (focusMode: FocusMode): Command => ({ do: "setLens", change: { focusMode }, time: null });
  return { redo: [set(mode)], undo: [set(before)] };
}

export const NO_CHANGE: Change = { redo: [], undo: [] };

/** Several changes as one; undone last to first. */
export function together(...changes: readonly Change[]): Change {
  return {
    redo: changes.flatMap((change) => change.redo),
    undo: changes.toReversed().flatMap((change) => change.undo),
  };
}
