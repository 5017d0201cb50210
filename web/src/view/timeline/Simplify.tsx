/** Makes few keys of the many of one setting, and says how far their curve is off. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import type { KeyedSetting } from "../../model/keys";
import { TypedNumber } from "../controls/TypedNumber";
import { parseQuantity, trim } from "../numbers";

export function Simplify({ session, setting }: { session: Session; setting: KeyedSetting }): JSX.Element {
  const { keys } = session;
  const tolerance = keys.tolerance.value;
  const found = session.document.simplified.value;
  return (
    <>
      <TypedNumber
        kind="frame"
        label="Tolerance of the curve"
        value={tolerance}
        format={(share) => `${trim(100 * share, 2)} %`}
        parse={(text) => {
          const typed = parseQuantity(text, "%");
          return typed !== null && typed > 0 && typed < 100 ? typed / 100 : null;
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
      {found?.setting === setting && (
        <span class="muted" role="status">
          {found.after} of {found.before} keys, at most {trim(100 * found.off, 2)} % off
        </span>
      )}
    </>
  );
}
