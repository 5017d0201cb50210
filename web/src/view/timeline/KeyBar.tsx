/** The selected keys in numbers: their frame, their value, and how the value goes on from them. */

import type { JSX } from "preact";
import { SHAPES } from "../../editor/key_actions";
import type { Session } from "../../editor/session";
import {
  isPlain,
  labelOf,
  lengthOf,
  mayBe,
  shapeOfAll,
  type KeyOwner,
  type KeyShape,
  type OwnedKey,
} from "../../model/key_lanes";
import { parseDistance, type LengthUnit } from "../../model/distance";
import { formatFrame } from "../../model/time";
import { valueSpanOf, type ValueSpan } from "../../model/value_scale";
import { Edits } from "../controls/Edits";
import { TypedNumber } from "../controls/TypedNumber";
import { parseQuantity, trim } from "../numbers";
import { Simplify } from "./Simplify";
import { formatValue, isDistance } from "./value_plot";

export function KeyBar({ session, unit }: { session: Session; unit: LengthUnit }): JSX.Element {
  const { keys } = session;
  const stacks = keys.selectedStacks.value.map((stack) => keys.shownAs(stack));
  const owned = stacks.flatMap((stack) => stack.keys);
  const first = stacks.toSorted((a, b) => a.time - b.time)[0];
  const [only] = owned;
  const length = lengthOf(stacks);
  const simplified = session.document.simplified.value;
  const setting = keys.whole.value;
  const span = valueSpanOf(stacks);
  return (
    <div class="key-bar" role="group" aria-label="Selected keys">
      <Edits session={session}>
        <span class="muted">
          {owned.length === 1 && only ? labelOf(only.owner) : `${owned.length.toString()} keys`}
        </span>
        {first && (
          <TypedNumber
            kind="frame"
            label="Frame of the keys"
            value={first.time}
            format={formatFrame}
            parse={(text) => parseQuantity(text, "")}
            example={formatFrame(session.shot.range.end)}
            onTyped={(time) => {
              keys.moveTo(time);
            }}
          />
        )}
        {length > 0 && (
          <TypedNumber
            kind="frame"
            label="Length of the keys, frames"
            value={length}
            format={formatFrame}
            parse={(text) => positive(parseQuantity(text, ""))}
            example="24"
            onTyped={(frames) => {
              keys.stretchTo(frames);
            }}
          />
        )}
        {owned.length === 1 && only && !isPlain(only.owner) && <Value session={session} owned={only} unit={unit} />}
        {span && <Span session={session} span={span} unit={unit} />}
        {!owned.every(({ owner }) => isPlain(owner)) && <ShapeChoice session={session} shape={shapeOfAll(stacks)} />}
        {setting && <Simplify session={session} setting={setting} />}
        {simplified && owned.every(({ owner }) => "setting" in owner && owner.setting === simplified.setting) && (
          <span class="muted simplified" role="status">
            {simplified.after} of {simplified.before} keys, at most {trim(100 * simplified.off, 2)} % off
          </span>
        )}
        <button
          type="button"
          class="button small"
          title="Remove the keys (Delete)"
          onClick={() => {
            void keys.remove();
          }}
        >
          Remove
        </button>
      </Edits>
    </div>
  );
}

/** The lowest and the highest value of several keys: another one spreads the values between both. */
function Span({
  session: { keys },
  span: { owner, least, most },
  unit,
}: {
  session: Session;
  span: ValueSpan;
  unit: LengthUnit;
}): JSX.Element {
  const typed = {
    format: (value: number) => formatValue(owner, value, unit),
    parse: (text: string) => parseValue(owner, text, unit),
    example: formatValue(owner, isDistance(owner) ? 3 : most, unit),
  };
  return (
    <>
      <TypedNumber
        {...typed}
        label="Lowest value of the keys"
        value={least}
        onTyped={(value) => {
          keys.respan(value, Math.max(value, most));
        }}
      />
      –
      <TypedNumber
        {...typed}
        label="Highest value of the keys"
        value={most}
        onTyped={(value) => {
          keys.respan(Math.min(value, least), value);
        }}
      />
    </>
  );
}

/** How the curve goes through the keys. */
function ShapeChoice({ session, shape }: { session: Session; shape: KeyShape | null }): JSX.Element {
  return (
    <select
      aria-label="Interpolation of the keys"
      title="How the value goes on to the next key"
      value={shape ?? ""}
      onChange={({ currentTarget }) => {
        session.keys.shape(currentTarget.value as KeyShape);
      }}
    >
      {shape === null && <option value="">Mixed</option>}
      {Object.entries(SHAPES).map(([name, label]) => (
        <option key={name} value={name}>
          {label}
        </option>
      ))}
    </select>
  );
}

function positive(value: number | null): number | null {
  return value !== null && value > 0 ? value : null;
}

/** A value that is typed; null for what is none, or may not be. */
function parseValue(owner: KeyOwner, text: string, unit: LengthUnit): number | null {
  const value = isDistance(owner) ? parseDistance(text, unit) : parseQuantity(text, "");
  return value !== null && mayBe(owner, value) ? value : null;
}

/** The value of one key; a distance in the unit of the page. */
function Value({ session, owned, unit }: { session: Session; owned: OwnedKey; unit: LengthUnit }): JSX.Element {
  const { owner } = owned;
  return (
    <TypedNumber
      label={`Value of ${labelOf(owner)}`}
      value={owned.key.value}
      format={(value) => formatValue(owner, value, unit)}
      parse={(text) => parseValue(owner, text, unit)}
      example={formatValue(owner, isDistance(owner) ? 3 : owned.key.value, unit)}
      onTyped={(value) => {
        session.keys.setValue(value);
      }}
    />
  );
}
