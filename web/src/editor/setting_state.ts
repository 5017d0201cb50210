/** A setting of the camera at one time, as its key is made of it. */

import type { Keyed, KeyedSetting } from "../model/keys";
import { EXPOSURE_DEFAULTS, FILM_DEFAULTS } from "../model/settings.gen";
import type { Service } from "../net/service";
import type { View } from "../net/view";

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
