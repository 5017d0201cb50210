/** A number or a switch of how the focus is found, with its key. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { settingKeyAt } from "../../model/changes";
import type { FocusNumber, FocusSettings } from "../../model/shot";
import type { FieldProps } from "../controls/Field";
import { KeyDiamond } from "../timeline/KeyDiamond";
import { parseQuantity, trim } from "../numbers";
import { Setting } from "../controls/Setting";

export interface FocusSettingsProps {
  readonly session: Session;
  readonly settings: FocusSettings;
}

interface AmountProps extends FocusSettingsProps {
  readonly name: FocusNumber;
  readonly label: string;
  readonly hint?: string;
  readonly scale: FieldProps["scale"];
  /** With the space that stands before it. */
  readonly unit: string;
  /** Value of one unit. */
  readonly per?: number;
  readonly places?: number;
  /** Text in place of 0. */
  readonly zero?: string;
}

export function Amount({
  session,
  settings,
  name,
  label,
  hint,
  scale,
  unit,
  per = 1,
  places = 0,
  zero,
}: AmountProps): JSX.Element {
  const format = (value: number): string => (value === 0 && zero ? zero : `${trim(value / per, places)}${unit}`);
  const isSigned = scale.min < 0;
  return (
    <Setting
      session={session}
      setting={name}
      keys={settings.keys}
      label={label}
      {...(hint === undefined ? {} : { hint })}
      value={settings[name]}
      scale={scale}
      fresh={session.document.fresh.value}
      example={format(scale.max / 2)}
      format={format}
      parse={(text) => {
        const value = text.trim() === zero ? 0 : parseQuantity(text, unit.trim());
        return value === null || (value < 0 && !isSigned) ? null : value * per;
      }}
      startDrag={() => session.dragFocus(label.toLowerCase(), name, settings)}
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
        label={label}
        what={label.toLowerCase()}
        keyed={(settings.keys[name] ?? []).length > 0}
        now={settingKeyAt(settings.keys, name, session.playhead.time.value) !== null}
        onToggle={() => {
          session.toggleSettingKey(label.toLowerCase(), name, Number(settings[name]), settings.keys);
        }}
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
