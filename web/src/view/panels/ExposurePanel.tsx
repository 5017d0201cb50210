/** Light meter, stop, shutter, sensitivity, filter and compensation: what makes the picture as bright as it is. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { agrees, formatTime, parseShutter, type ExposureSettings, type Photography } from "../../model/photography";
import { EXPOSURE_SLIDERS } from "../../model/settings.gen";
import type { Readout } from "../../model/shot";
import { BrightnessLine } from "./Brightness";
import { LightMeter } from "./LightMeter";
import { ExposureField, type ExposureSlider } from "../controls/ExposureField";
import { quantityOf, type Quantity } from "../controls/quantity";
import { parseQuantity, trim } from "../numbers";
import { Setting } from "../controls/Setting";
import { StopSetting } from "../controls/StopSetting";
import { Edits } from "../controls/Edits";
import { Section } from "./Section";
import { Radios } from "../controls/Radios";

interface PartProps {
  readonly session: Session;
  readonly current: Photography;
}

export function ExposurePanel({ session, current }: PartProps): JSX.Element {
  return (
    <Section
      name="exposure"
      title="Exposure"
      aside={
        <span class="muted" title="Exposure value of stop, time and ISO, at ISO 100">
          EV <b data-meter="ev">{trim(current.readout.ev100, 1)}</b>
        </span>
      }
    >
      <div class="fields">
        <BrightnessLine current={current} />
        <LightMeter session={session} exposure={current.exposure} />
        <Edits session={session}>
          <Stop session={session} current={current} />
          <Shutter session={session} current={current} />
          <Numbers session={session} exposure={current.exposure} />
        </Edits>
      </div>
    </Section>
  );
}

/** The stop that exposes: the iris's, or one of its own. */
function Stop({ session, current }: PartProps): JSX.Element | null {
  const lens = session.document.readout.value;
  if (!lens) return null;
  const { exposure, readout } = current;
  const byIris = exposure.exposureStop === "iris";
  const bellows = readout.bellowsFactor > 1.005 ? ` As focused it is worth T ${trim(readout.effectiveTStop, 2)}.` : "";
  const pointsSetIt = byIris && session.pointsSetStop.value;
  return (
    <>
      <StopSetting
        {...stopField(session, exposure, lens)}
        session={session}
        marking={exposure.stopMarking}
        transmittance={exposure.transmittance}
        disabled={pointsSetIt}
        hint={`${pointsSetIt ? SET_BY_POINTS : byIris ? BY_IRIS : BY_EXPOSURE}${bellows}`}
      />
      <div class="stop-row">
        <label class="switch-row" title="On, stopping down darkens the picture; off, it only deepens the focus">
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
      </div>
    </>
  );
}

const SET_BY_POINTS = "The focus points set the iris.";
const BY_IRIS = "The stop of the iris, in thirds; hold Alt for anything between, or type it.";
const BY_EXPOSURE =
  "A stop that exposes and leaves the iris alone, in thirds; hold Alt for anything between, or type it.";

const MARKINGS = {
  f: "The lens is marked in f-numbers: the light that the glass takes darkens the picture",
  t: "The lens is marked in T-stops, as for the cinema: they have in them what the glass takes",
};

/** What the stops on the barrel are. */
function Marking({ session, exposure }: { session: Session; exposure: ExposureSettings }): JSX.Element {
  return (
    <Radios
      label="The lens is marked in"
      values={["f", "t"] as const}
      value={exposure.stopMarking}
      names={{ f: "f", t: "T" }}
      titles={MARKINGS}
      onChoose={(stopMarking) => {
        session.photography.setExposure("Stop marking", { stopMarking }, exposure);
      }}
    />
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

function Shutter({ session, current }: PartProps): JSX.Element {
  const { exposure, readout } = current;
  const { photography } = session;
  const perSecond = session.shot.range.framesPerSecond;
  return (
    <>
      <Setting
        session={session}
        setting="shutterClose"
        keys={exposure.keys}
        {...quantityOf(EXPOSURE_SLIDERS.shutterAngleDeg, {
          hint: "Twice the angle is twice the blur and twice the light; type 180° or 1/50 s",
          example: "180° or 1/50 s",
          parse: (text) => (text.trim() === "still" ? 0 : parseShutter(text, perSecond)),
        })}
        value={exposure.shutterAngleDeg}
        fresh={photography.fresh.value}
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
              photography.matchShutter(current);
            }}
          >
            Match
          </button>
        )}
      </p>
    </>
  );
}

const LOG2_10 = Math.log2(10);

/** What is shown or typed in its own way. */
const SPECIAL: Readonly<Record<string, Partial<Quantity>>> = {
  iso: {
    format: (iso) => trim(iso, iso < 100 ? 1 : 0),
    parse: (text) => parseQuantity(text.replace(/^iso/i, ""), ""),
  },
  neutralDensity: {
    example: "0.6 or 2 stops",
    format: (density) => (density === 0 ? "none" : `${trim(density, 2)} (−${trim(density * LOG2_10, 1)})`),
    parse: (text) => {
      const stops = /^([\d.,]+)\s*stops?$/i.exec(text.trim());
      if (stops) return Number(((parseQuantity(stops[1] ?? "", "") ?? 0) / LOG2_10).toFixed(3));
      return text.trim() === "none" ? 0 : parseQuantity(text.replace(/^nd/i, "").replace(/\(.*\)$/, ""), "");
    },
  },
};

const IN_PANEL = Object.values(EXPOSURE_SLIDERS).filter(
  ({ panel }) => panel === "exposure",
) as readonly ExposureSlider[];
const [AMOUNTS, COMPENSATION] = [
  IN_PANEL.filter(({ name }) => name !== "compensationStops"),
  EXPOSURE_SLIDERS.compensationStops,
];

function Numbers({ session, exposure }: { session: Session; exposure: ExposureSettings }): JSX.Element {
  const byMeter = exposure.meteringMode !== "manual";
  const props = { session, exposure };
  return (
    <>
      {AMOUNTS.map((declared) => (
        <ExposureField key={declared.name} {...props} declared={declared} special={SPECIAL[declared.name]} />
      ))}
      <ExposureField {...props} declared={COMPENSATION} disabled={byMeter} />
    </>
  );
}
