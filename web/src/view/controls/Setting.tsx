/** One number of a camera's settings: its diamond and its field. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { settingKeyAt } from "../../model/changes";
import { mayBe } from "../../model/key_lanes";
import type { Keyed, KeyedSetting } from "../../model/keys";
import { Field, type FieldProps, type Typed } from "./Field";
import { KeyDiamond } from "../timeline/KeyDiamond";

interface SettingProps extends FieldProps {
  readonly session: Session;
  /** Takes the keys. */
  readonly setting: KeyedSetting;
  readonly keys: Keyed;
}

export function Setting({ session, setting, keys, ...field }: SettingProps): JSX.Element {
  const checked = <Kind extends Typed>(typed: Kind): Kind => ({
    ...typed,
    parse: (text) => {
      const value = typed.parse(text);
      return value !== null && mayBe({ setting }, value) ? value : null;
    },
  });
  return (
    <div class="setting" data-setting={setting}>
      <KeyDiamond
        session={session}
        label={field.label}
        what={field.label.toLowerCase()}
        keyed={(keys[setting] ?? []).length > 0}
        now={settingKeyAt(keys, setting, session.playhead.time.value) !== null}
        fresh={field.fresh}
        onToggle={() => session.toggleSettingKey(field.label.toLowerCase(), setting)}
      />
      <Field {...checked(field)} {...(field.also && { also: checked(field.also) })} />
    </div>
  );
}
