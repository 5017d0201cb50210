/** Keys as the service has them now, which may be others than the page has read. */

import type { ReadonlySignal } from "@preact/signals";
import type { Change, Changes } from "../model/changes";
import {
  CAMERA_PLACE,
  laneOf,
  lanesOf,
  type KeyLane,
  type KeyOwner,
  type ValueKey,
  type ValueOwner,
} from "../model/key_lanes";
import type { Key } from "../model/keys";
import type { Photography } from "../model/photography";
import { keysOf, type FocusPoint } from "../model/shot";
import { sameTime } from "../model/time";
import type { Service } from "../net/service";
import type { CameraPlaceReader } from "./camera_place";
import type { ShotDocument } from "./document";
import { goneHint } from "./hints";
import type { PointNames } from "./point_names";
import { readSetting } from "./setting_state";

/** Parts of a session that have keys. */
interface KeyedParts {
  readonly document: ShotDocument;
  readonly photography: { readonly current: ReadonlySignal<Photography | null> };
  readonly cameraPlace: CameraPlaceReader;
}

/** Reads the keys of a setting or attribute; null where its focus point is gone. */
export type ReadKeys = (owner: KeyOwner) => Promise<readonly Key[] | null>;

/** Reads the keys of a setting, or of an attribute of a focus point; null where the point is gone. */
export async function readKeys(
  service: Service,
  document: ShotDocument,
  owner: KeyOwner,
  time: number,
): Promise<readonly Key[] | null> {
  if ("place" in owner) return (await service.fromAbove.cameraPlace(document.view, time)).keys;
  if ("setting" in owner) {
    const { keys } = await readSetting(service, document.view, owner.setting, time);
    return keys[owner.setting] ?? [];
  }
  const point = (await document.pointsAt(time)).find(({ name }) => name === owner.point);
  return point ? keysOf(point, owner.attribute) : null;
}

/**
 * Leaves out changes of keys whose focus point is gone, and those that remove keys which are gone.
 *
 * @throws HintError where the points of all changes are gone.
 */
export async function withoutGone(changes: Changes, read: ReadKeys): Promise<Changes> {
  const found = new Map<string, ReturnType<ReadKeys>>();
  const gone: KeyOwner[] = [];
  const isThere = async (change: Change): Promise<boolean> => {
    const owner = ownerOf(change);
    if (!owner) return true;
    const name = `${laneOf(owner)} ${"point" in owner ? owner.attribute : ""}`;
    const keys = found.get(name) ?? read(owner);
    found.set(name, keys);
    const now = await keys;
    if (now === null) gone.push(owner);
    if (now === null || !isRemoval(change)) return now !== null;
    return now.some(({ time }) => sameTime(time, change.time));
  };
  const isKept = await Promise.all(changes.map(isThere));
  const kept = changes.filter((_, place) => isKept[place]);
  const [first] = gone;
  if (first && kept.length === 0) throw goneHint(first);
  return kept;
}

/** The lanes of all keys as last read. */
export function lanesNow({ document, photography, cameraPlace }: KeyedParts): KeyLane[] {
  const current = photography.current.value;
  const keyed = [document.focusSettings.value?.keys, current?.exposure.keys, current?.film.keys];
  return lanesOf(
    keyed.filter((keys) => keys !== undefined),
    document.points.value,
    cameraPlace.keys.value,
  );
}

/** The keys of settings, and of the focus points that there are. */
export function withOwners(keys: readonly ValueKey[], points: readonly FocusPoint[]): ValueKey[] {
  const names = new Set(points.map(({ name }) => name));
  return keys.filter(({ owner }) => "setting" in owner || names.has(owner.point));
}

/** Returns a function that tells what the owner of a curve is called by then. */
export function followOwner(owner: ValueOwner, names: PointNames): () => ValueOwner {
  if ("setting" in owner) return () => owner;
  const nameNow = names.follow(owner.point);
  return () => ({ ...owner, point: nameNow() });
}

/** Returns a function that gives the keys with what their owners are called by then. */
export function followKeys(keys: readonly ValueKey[], names: PointNames): () => readonly ValueKey[] {
  const followed = keys.map(({ owner, key }) => ({ key, ownerNow: followOwner(owner, names) }));
  return () => followed.map(({ key, ownerNow }) => ({ owner: ownerNow(), key }));
}

/** Returns a function that makes the changes by the names which the points have by then. */
export function follow(changes: Changes, names: PointNames): () => Changes {
  const points = new Set(changes.filter(isOfPoint).map(({ name }) => name));
  const nameNow = new Map([...points].map((name) => [name, names.follow(name)]));
  return () => {
    const nameOf = (name: string): string => nameNow.get(name)?.() ?? name;
    return changes.map((change) => (isOfPoint(change) ? { ...change, name: nameOf(change.name) } : change));
  };
}

type Removal = Extract<Change, { type: "unkeySetting" | "unkeyPoint" | "unkeyCamera" }>;
type PointKeyChange = Extract<Change, { type: "keyPoint" | "unkeyPoint" }>;

function isRemoval(change: Change): change is Removal {
  return change.type === "unkeySetting" || change.type === "unkeyPoint" || change.type === "unkeyCamera";
}

function isOfPoint(change: Change): change is PointKeyChange {
  return change.type === "keyPoint" || change.type === "unkeyPoint";
}

/** What a change of keys needs to know the keys of; null for none. */
function ownerOf(change: Change): KeyOwner | null {
  if (change.type === "unkeyCamera") return CAMERA_PLACE;
  if (change.type === "unkeySetting") return { setting: change.setting };
  return isOfPoint(change) ? { point: change.name, attribute: change.attribute } : null;
}
