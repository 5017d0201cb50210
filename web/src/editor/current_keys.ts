/** Keys as the service has them now, which may be others than the page has read. */

import type { Change, Changes } from "../model/changes";
import { laneOf, type KeyOwner } from "../model/key_lanes";
import type { Key } from "../model/keys";
import { keysOf } from "../model/shot";
import { sameTime } from "../model/time";
import type { Service } from "../net/service";
import type { ShotDocument } from "./document";
import { readSetting } from "./setting_state";

/** Reads the keys of a setting or attribute. */
export type ReadKeys = (owner: KeyOwner) => Promise<readonly Key[]>;

/** Reads the keys of a setting, or of an attribute of a focus point. */
export async function readKeys(
  service: Service,
  document: ShotDocument,
  owner: KeyOwner,
  time: number,
): Promise<readonly Key[]> {
  if ("setting" in owner) {
    const { keys } = await readSetting(service, document.view, owner.setting, time);
    return keys[owner.setting] ?? [];
  }
  const point = (await document.pointsAt(time)).find(({ name }) => name === owner.point);
  return point ? keysOf(point, owner.attribute) : [];
}

/** Leaves out changes that remove keys which are gone. */
export async function withoutGone(changes: Changes, read: ReadKeys): Promise<Changes> {
  const found = new Map<string, Promise<readonly Key[]>>();
  const isThere = async (change: Change): Promise<boolean> => {
    const owner = ownerOfRemoved(change);
    if (!owner || !("time" in change)) return true;
    const name = `${laneOf(owner)} ${"setting" in owner ? "" : owner.attribute}`;
    const keys = found.get(name) ?? read(owner);
    found.set(name, keys);
    return (await keys).some(({ time }) => sameTime(time, change.time ?? NaN));
  };
  const kept = await Promise.all(changes.map(isThere));
  return changes.filter((_, place) => kept[place]);
}

/** What loses a key by a change; null where none does. */
function ownerOfRemoved(change: Change): KeyOwner | null {
  if (change.type === "unkeySetting") return { setting: change.setting };
  return change.type === "unkeyPoint" ? { point: change.name, attribute: change.attribute } : null;
}
