/** One number of a camera's settings: its diamond and its field. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { settingKeyAt } from "../../model/changes";
import type { Keyed, KeyedSetting } from "../../model/keys";
import { Field, type FieldProps } from "./Field";
import { KeyDiamond } from "../timeline/KeyDiamond";

interface SettingProps extends FieldProps {
  readonly session: Session;
  /** Takes the keys. */
  readonly setting: KeyedSetting;
  /** Value of the keyed setting, where it is not `value`. */
  readonly keyValue?: number;
  readonly keys: Keyed;
}

export function Setting({ session, setting, keys, keyValue, ...field }: SettingProps): JSX.Element {
  return (
    <div class="setting">
      <KeyDiamond
        label={field.label}
        what={field.label.toLowerCase()}
        keyed={(keys[setting] ?? []).length > 0}
        now={settingKeyAt(keys, setting, session.playhead.time.value) !== null}
        onToggle={() => {
          session.toggleSettingKey(field.label.toLowerCase(), setting, keyValue ?? field.value, keys);
        }}
      />
      <Field {...field} />
    </div>
  );
}
