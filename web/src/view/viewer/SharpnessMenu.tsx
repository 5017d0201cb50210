/** The choice of what is shown of the sharpness of the picture. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import { DELIVERIES, LIMITS, LOOKS, type Delivery, type Limit, type Look } from "../../model/sharpness";
import { Choice, Options } from "../controls/Choice";
import { Menu } from "../controls/Menu";
import { Radios } from "../controls/Radios";

const LOOK_NAMES: Readonly<Record<Look, string>> = { none: "Nothing", peaking: "Peaking", falseColour: "False colour" };
const LIMIT_NAMES: Readonly<Record<Limit, string>> = {
  film: "the depth of field's limit",
  "1": "1 px across",
  "2": "2 px across",
  "4": "4 px across",
};

export function SharpnessMenu({ editor }: { editor: Editor }): JSX.Element {
  const { look, focusLines, probe, limit, delivery } = editor.remembered;
  return (
    <Menu name="sharpness" label="Sharpness on the picture" title="Sharpness on the picture (P)" head="Sharpness">
      {() => (
        <div class="sharpness-choices">
          <Radios
            label="Sharpness as"
            values={LOOKS}
            value={look.value}
            names={LOOK_NAMES}
            onChoose={(name) => (look.value = name)}
          />
          <Switch label="Lines of focus and its limits" choice={focusLines} />
          <Switch label="Probe at the pointer" choice={probe} />
          <Choice
            label="Sharp is"
            value={limit.value}
            hint="Largest circle of confusion that counts as sharp"
            onChoose={(chosen) => (limit.value = chosen as Limit)}
          >
            <Options values={LIMITS} names={LIMIT_NAMES} />
          </Choice>
          <Choice
            label="Delivered at"
            value={delivery.value}
            hint="Width of delivered pictures, by which circles are given in pixels"
            onChoose={(chosen) => (delivery.value = chosen as Delivery)}
          >
            <Options values={DELIVERIES} names={DELIVERY_NAMES} />
          </Choice>
        </div>
      )}
    </Menu>
  );
}

const DELIVERY_NAMES: Readonly<Record<Delivery, string>> = {
  "1280": "1280 px, HD 720",
  "1920": "1920 px, HD",
  "2048": "2048 px, 2K",
  "3840": "3840 px, UHD",
  "4096": "4096 px, 4K",
};

function Switch({ label, choice }: { label: string; choice: { value: "on" | "off" } }): JSX.Element {
  return (
    <label class="check">
      <input
        type="checkbox"
        checked={choice.value === "on"}
        onChange={(event) => (choice.value = event.currentTarget.checked ? "on" : "off")}
      />
      {label}
    </label>
  );
}
