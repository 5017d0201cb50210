/** A number or a switch of how the focus is found, with its key. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { settingKeyAt } from "../../model/changes";
import type { FocusNumber, FocusSettings } from "../../model/shot";
import { FOCUS_SLIDERS } from "../../model/settings.gen";
import { KeyDiamond } from "../timeline/KeyDiamond";
import { quantityOf } from "../controls/quantity";
import { Setting } from "../controls/Setting";

export interface FocusSettingsProps {
  readonly session: Session;
  readonly settings: FocusSettings;
}

interface AmountProps extends FocusSettingsProps {
  readonly name: FocusNumber;
}

export function Amount({ session, settings, name }: AmountProps): JSX.Element {
  const declared = FOCUS_SLIDERS[name];
  return (
    <Setting
      {...quantityOf(declared)}
      session={session}
      setting={name}
      keys={settings.keys}
      value={settings[name]}
      fresh={session.document.fresh.value}
      startDrag={() => session.dragFocus(declared.label.toLowerCase(), name, settings)}
    />
  );
}

interface SwitchProps extends FocusSettingsProps {
  readonly name: "solveStop" | "drivenByPoints";
  readonly label: string;
  readonly hint: string;
  /** Label of the edit. */
  readonly onEdit: (on: boolean) => string;
}

export function Switch({ session, settings, name, label, hint, onEdit }: SwitchProps): JSX.Element {
  return (
    <div class="setting">
      <KeyDiamond
        session={session}
        label={label}
        what={label.toLowerCase()}
        keyed={(settings.keys[name] ?? []).length > 0}
        now={settingKeyAt(settings.keys, name, session.playhead.time.value) !== null}
        fresh={session.document.fresh.value}
        onToggle={() => session.toggleSettingKey(label.toLowerCase(), name)}
      />
      <label class="switch-row" title={hint}>
        <input
          type="checkbox"
          class="switch"
          checked={settings[name]}
          onChange={({ currentTarget: { checked } }) => {
            session.setFocusSwitch(onEdit(checked), name, checked, settings);
          }}
        />
        {label}
      </label>
    </div>
  );
}
