/** Settings of the selected focus point: kind, reach on a focal surface, and a rack to another point. */

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import type { Session } from "../../editor/session";
import { keyAt, valueOf, type SimpleAttribute } from "../../model/changes";
import { POINT_SLIDERS } from "../../model/settings.gen";
import { EASES, keysOf, type Ease, type FocusPoint } from "../../model/shot";
import { Field } from "../controls/Field";
import { formatIn, quantityOf } from "../controls/quantity";
import { KeyDiamond } from "../timeline/KeyDiamond";
import { parseQuantity, trim } from "../numbers";
import { FollowedPart } from "./FollowedPart";
import { PointColorChoice, PointGroupField } from "./PointLabels";
import { Radios } from "../controls/Radios";
import { TextSetting } from "../controls/TextSetting";

export function PointSettings({ session, point }: { session: Session; point: FocusPoint }): JSX.Element {
  const mode = session.document.readout.value?.focusMode;
  const { kind } = point.settings;
  return (
    <div class="point-more">
      <TextSetting
        label="Name"
        value={point.name}
        title="Enter renames the point; its keys stay"
        onType={(typed) => session.pointEdits.rename(point, typed.trim() || point.name)}
      />
      <PointColorChoice session={session} point={point} />
      <PointGroupField session={session} point={point} />
      <FollowedPart session={session} point={point} />
      <Radios
        label={`${point.name} is`}
        values={["sharp", "soft"] as const}
        value={kind}
        names={{ sharp: "Sharp", soft: "Soft" }}
        onChoose={(choice) => {
          if (choice !== kind) void session.pointEdits.setKind(point, choice);
        }}
      />
      {kind === "soft" && <Amount session={session} point={point} attribute="blur" />}
      {mode === "surface" && (
        <>
          <Amount session={session} point={point} attribute="extent" />
          <Amount session={session} point={point} attribute="falloff" />
        </>
      )}
      {mode !== "manual" && <RackTo session={session} point={point} />}
    </div>
  );
}

interface AmountProps {
  readonly session: Session;
  readonly point: FocusPoint;
  readonly attribute: "blur" | "extent" | "falloff";
}

function Amount({ session, point, attribute }: AmountProps): JSX.Element {
  const declared = POINT_SLIDERS[attribute];
  const { slider, label } = declared;
  const format = (value: number): string => (value === 0 && slider.zero ? slider.zero : formatIn(slider, value, 3));
  return (
    <div class="point-amount">
      <KeyButton session={session} point={point} attribute={attribute} />
      <Field
        {...quantityOf(declared, { format, example: format(slider.most / 2) })}
        value={valueOf(point, attribute)}
        fresh={session.document.fresh.value}
        startDrag={() => session.dragPoint(`${label} of ${point.name}`, point, attribute)}
      />
    </div>
  );
}

const EASE_NAMES: Readonly<Record<Ease, string>> = {
  smooth: "smooth",
  in: "soft start",
  out: "soft end",
  linear: "even",
};

/** From this point to another one, from the playhead on. */
function RackTo({ session, point }: { session: Session; point: FocusPoint }): JSX.Element | null {
  const others = session.document.points.value.map(({ name }) => name).filter((name) => name !== point.name);
  const perSecond = session.shot.range.framesPerSecond;
  const [to, setTo] = useState<string | null>(null);
  const [frames, setFrames] = useState(() => Math.max(1, Math.round(perSecond)).toString());
  const [ease, setEase] = useState<Ease>("smooth");
  const target = others.find((name) => name === to) ?? others[0];
  const length = parseQuantity(frames, "");
  const isLength = length !== null && length > 0;
  if (target === undefined) return null;
  return (
    <form
      class="rack"
      aria-label={`Rack from ${point.name}`}
      onSubmit={(event) => {
        event.preventDefault();
        if (isLength) void session.pointEdits.rack(point, target, length, ease);
      }}
    >
      <span>Rack to</span>
      <select
        aria-label="Point to rack to"
        value={target}
        onChange={(event) => {
          setTo(event.currentTarget.value);
        }}
      >
        {others.map((name) => (
          <option key={name}>{name}</option>
        ))}
      </select>
      <span>over</span>
      <input
        type="text"
        class="number"
        inputMode="decimal"
        aria-label="Length of the rack in frames"
        aria-invalid={!isLength}
        title={isLength ? `${trim(length / perSecond, 2)} s` : undefined}
        value={frames}
        onInput={(event) => {
          setFrames(event.currentTarget.value);
        }}
      />
      <span>frames,</span>
      <select
        aria-label="How the rack goes"
        value={ease}
        onChange={({ currentTarget }) => {
          setEase(EASES.find((choice) => choice === currentTarget.value) ?? "smooth");
        }}
      >
        {EASES.map((choice) => (
          <option key={choice} value={choice}>
            {EASE_NAMES[choice]}
          </option>
        ))}
      </select>
      <button type="submit" class="button small" title="Starts at the playhead; the lens may need longer than this">
        Rack
      </button>
      {!isLength && <LengthHint example={Math.round(perSecond)} />}
    </form>
  );
}

function LengthHint({ example }: { example: number }): JSX.Element {
  return (
    <span class="number-hint" role="alert">
      Type for example {example}
    </span>
  );
}

export function KeyButton({
  session,
  point,
  attribute,
}: {
  session: Session;
  point: FocusPoint;
  attribute: SimpleAttribute;
}): JSX.Element {
  const key = keyAt(point, attribute, session.playhead.time.value);
  const keyed = keysOf(point, attribute).length > 0;
  return (
    <KeyDiamond
      session={session}
      label={`${point.name}, ${attribute}`}
      what={attribute}
      keyed={keyed}
      now={key !== null}
      shortcut={attribute === "weight" ? " (S)" : ""}
      fresh={session.document.fresh.value}
      onToggle={() => session.toggleKey(point, attribute)}
    />
  );
}
