/** A setting of the camera at one time, as its key is made of it, and keys as the service has them. */

import type { KeyOwner } from "../model/key_lanes";
import type { Key, Keyed, KeyedSetting } from "../model/keys";
import { EXPOSURE_DEFAULTS, FILM_DEFAULTS } from "../model/settings.gen";
import { keysOf } from "../model/shot";
import type { Service } from "../net/service";
import type { View } from "../net/view";
import type { ShotDocument } from "./document";

export interface SettingState {
  /** A switch is 0 or 1. */
  readonly value: number;
  /** Keys of this setting and of others. */
  readonly keys: Keyed;
}

/** Reads a setting at a time. */
export async function readSetting(
  service: Service,
  view: View,
  setting: KeyedSetting,
  time: number,
): Promise<SettingState> {
  if (setting in EXPOSURE_DEFAULTS || setting in FILM_DEFAULTS) {
    const { exposure, film } = await service.photography(view, time);
    return stateIn(setting in EXPOSURE_DEFAULTS ? exposure : film, setting);
  }
  const [lens, focus] = await Promise.all([service.readout(view, time), service.focusSettings(view, time)]);
  // The angles of the lens are the solved ones; those of the focus settings take keys.
  return stateIn({ ...lens, ...focus }, setting);
}

function stateIn(values: { readonly keys: Keyed }, setting: KeyedSetting): SettingState {
  return { value: Number((values as Readonly<Record<string, unknown>>)[setting]), keys: values.keys };
}

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
