/** Light meter, stop, shutter, sensitivity, filter and compensation: what makes the picture as bright as it is. */

import type { JSX } from "preact";
import type { CameraPhotography } from "../../editor/photography";
import type { Session } from "../../editor/session";
import {
  agrees,
  formatStops,
  formatTime,
  parseShutter,
  type ExposureNumber,
  type ExposureSettings,
  type Photography,
} from "../../model/photography";
import { COMPENSATIONS, DENSITIES, F_NUMBERS, ISOS, SHUTTER_ANGLES_DEG, type Scale } from "../../model/scale";
import type { Readout } from "../../model/shot";
import { LightMeter } from "./LightMeter";
import { parseQuantity, trim } from "../numbers";
import { Setting } from "../controls/Setting";

interface PartProps {
  readonly session: Session;
  readonly said: Photography;
}

export function ExposurePanel({ session, said }: PartProps): JSX.Element {
  return (
    <section class="exposure" aria-labelledby="exposure-title">
      <div class="panel-head">
        <h2 id="exposure-title">Exposure</h2>
        <span class="muted" title="Exposure value of stop, time and ISO, at ISO 100">
          EV <b data-meter="ev">{trim(said.readout.ev100, 1)}</b>
        </span>
      </div>
      <div class="fields">
        <LightMeter session={session} exposure={said.exposure} />
        <Stop session={session} said={said} />
        <Shutter session={session} said={said} />
        <Numbers session={session} exposure={said.exposure} />
      </div>
    </section>
  );
}

/** The stop that exposes: the iris's, or one of its own. */
function Stop({ session, said }: PartProps): JSX.Element | null {
  const lens = session.document.readout.value;
  if (!lens) return null;
  const { exposure, readout } = said;
  const byIris = exposure.exposureStop === "iris";
  const letter = exposure.stopMarking === "t" ? "T" : "f/";
  const worth = `T${trim(readout.effectiveTStop, 1)}`;
  const bellows =
    readout.bellowsFactor > 1.005 ? `, with ${trim(Math.log2(readout.bellowsFactor), 1)} stops of bellows` : "";
  return (
    <>
      <Setting
        {...stopField(session, exposure, lens)}
        session={session}
        label="Stop"
        hint={`${byIris ? "The iris" : "Of the exposure alone"}; worth ${worth}${bellows}`}
        scale={F_NUMBERS}
        example="2.8"
        format={(value) => (value === 0 ? "pinhole" : `${letter}${trim(value, 2)}`)}
        parse={(text) => parseQuantity(text.replace(/^[ft]\s*\/?/i, ""), "")}
      />
      <div class="stop-row">
        <label class="switch-row" title="On, stopping down darkens the picture as it deepens the focus">
          <input
            type="checkbox"
            class="switch"
            checked={byIris}
            onChange={({ currentTarget: { checked } }) => {
              session.photography.setExposureStop(checked ? "iris" : "exposure", exposure, lens.fStop);
            }}
          />
          The iris exposes
        </label>
        <Marking session={session} exposure={exposure} />
        <span class="muted" title="The stop that the light goes by, with what the glass takes" data-meter="t-stop">
          {worth}
        </span>
      </div>
    </>
  );
}

const MARKINGS = {
  f: "f-numbers: what the glass takes darkens the picture",
  t: "T-stops, as on lenses for the cinema",
};

/** What the stops on the barrel are. */
function Marking({ session, exposure }: { session: Session; exposure: ExposureSettings }): JSX.Element {
  return (
    <div class="group" role="radiogroup" aria-label="The stops are">
      {(["f", "t"] as const).map((marking) => (
        <button
          key={marking}
          type="button"
          class="button small"
          role="radio"
          aria-checked={exposure.stopMarking === marking}
          title={MARKINGS[marking]}
          onClick={() => {
            session.photography.setExposure("Stop marking", { stopMarking: marking }, exposure);
          }}
        >
          {marking === "f" ? "f" : "T"}
        </button>
      ))}
    </div>
  );
}

type StopField = Pick<Parameters<typeof Setting>[0], "setting" | "keys" | "value" | "fresh" | "startDrag">;

function stopField(session: Session, exposure: ExposureSettings, lens: Readout): StopField {
  if (exposure.exposureStop === "iris")
    return {
      setting: "fStop",
      keys: session.document.focusSettings.value?.keys ?? {},
      value: lens.fStop,
      fresh: session.document.fresh.value,
      startDrag: () => session.dragLens("stop", "fStop", lens),
    };
  return {
    setting: "exposureFStop",
    keys: exposure.keys,
    value: exposure.exposureFStop,
    fresh: session.photography.fresh.value,
    startDrag: () => session.photography.dragExposure("stop", "exposureFStop", exposure),
  };
}

function Shutter({ session, said }: PartProps): JSX.Element {
  const { exposure, readout } = said;
  const { photography } = session;
  const perSecond = session.shot.range.framesPerSecond;
  return (
    <>
      <Setting
        session={session}
        setting="shutterClose"
        keyValue={exposure.shutterAngleDeg / 360}
        keys={exposure.keys}
        label="Shutter"
        hint="Twice the angle is twice the blur and twice the light; type 180° or 1/50 s"
        value={exposure.shutterAngleDeg}
        scale={SHUTTER_ANGLES_DEG}
        fresh={photography.fresh.value}
        example="180° or 1/50 s"
        format={(angle) => (angle === 0 ? "still" : `${trim(angle, 1)}°`)}
        parse={(text) => (text.trim() === "still" ? 0 : parseShutter(text, perSecond))}
        startDrag={() => photography.dragShutter(exposure)}
      />
      <p class="setting-said muted">
        <span>
          Open <span data-meter="shutter">{formatTime(readout.shutterTimeS)}</span>, exposed{" "}
          {formatTime(exposure.exposureTimeS)}
        </span>
        {!agrees(exposure, readout) && (
          <button
            type="button"
            class="button small"
            title="Exposes for as long as the shutter is open; compensation keeps the picture as bright"
            onClick={() => {
              photography.matchShutter(said);
            }}
          >
            Match
          </button>
        )}
      </p>
    </>
  );
}

interface NumberRow {
  readonly name: ExposureNumber;
  readonly label: string;
  readonly hint: string;
  readonly scale: Scale;
  readonly example: string;
  readonly format: (value: number) => string;
  readonly parse: (text: string) => number | null;
}

const LOG2_10 = Math.log2(10);
const NUMBERS: readonly NumberRow[] = [
  {
    name: "iso",
    label: "ISO",
    hint: "Twice the speed is a stop",
    scale: ISOS,
    example: "800",
    format: (iso) => trim(iso, iso < 100 ? 1 : 0),
    parse: (text) => parseQuantity(text.replace(/^iso/i, ""), ""),
  },
  {
    name: "neutralDensity",
    label: "ND",
    hint: "Density of the filter in front; 0.3 takes a stop",
    scale: DENSITIES,
    example: "0.6 or 2 stops",
    format: (density) => (density === 0 ? "none" : `${trim(density, 2)} (−${trim(density * LOG2_10, 1)})`),
    parse: (text) => {
      const stops = /^([\d.,]+)\s*stops?$/i.exec(text.trim());
      if (stops) return Number(((parseQuantity(stops[1] ?? "", "") ?? 0) / LOG2_10).toFixed(3));
      return text.trim() === "none" ? 0 : parseQuantity(text.replace(/^nd/i, "").replace(/\(.*\)$/, ""), "");
    },
  },
  {
    name: "compensationStops",
    label: "Compensation",
    hint: "Brighter or darker than what is set; it does not count where the meter exposes",
    scale: COMPENSATIONS,
    example: "+1",
    format: (stops) => `${formatStops(stops)} stops`,
    parse: (text) => parseQuantity(text.replace("±", ""), text.trim().endsWith("stop") ? "stop" : "stops"),
  },
];

function Numbers({ session, exposure }: { session: Session; exposure: ExposureSettings }): JSX.Element {
  const photography: CameraPhotography = session.photography;
  const byMeter = exposure.meteringMode !== "manual";
  return (
    <>
      {NUMBERS.map(({ name, ...row }) => (
        <Setting
          {...row}
          key={name}
          session={session}
          setting={name}
          keys={exposure.keys}
          value={exposure[name]}
          disabled={byMeter && name === "compensationStops"}
          fresh={photography.fresh.value}
          startDrag={() => photography.dragExposure(row.label, name, exposure)}
        />
      ))}
    </>
  );
}
