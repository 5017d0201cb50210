/** Makes fewer keys of the many of one setting, within a tolerance. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import type { KeyedSetting } from "../../model/keys";
import { TypedNumber } from "../controls/TypedNumber";
import { parseQuantity, trim } from "../numbers";

export function Simplify({ session, setting }: { session: Session; setting: KeyedSetting }): JSX.Element {
  const { keys } = session;
  const tolerance = keys.tolerance.value;
  return (
    <>
      <TypedNumber
        kind="frame"
        label="Tolerance of the curve"
        value={tolerance}
        format={(share) => `${trim(100 * share, 2)} %`}
        parse={(text) => {
          const typed = parseQuantity(text, "%");
          return typed !== null && typed >= 0.01 && typed < 100 ? typed / 100 : null;
        }}
        example="2 %"
        onTyped={(share) => {
          keys.tolerance.value = share;
        }}
      />
      <button
        type="button"
        class="button small"
        title="Replace all keys of this value by few whose curve is at most so far off"
        onClick={() => {
          void keys.simplify(setting);
        }}
      >
        Simplify
      </button>
    </>
  );
}
