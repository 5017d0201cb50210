/** A light meter: how far over or under the exposure is, and what light it saw. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import {
  formatStops,
  type ExposureChange,
  type ExposureSettings,
  type MeterMode,
  type MeterReading,
} from "../../model/photography";
import { sameTime } from "../../model/time";
import { trim } from "../numbers";
import { Edits } from "../controls/Edits";
import { Reading } from "../controls/Reading";
import { Waiting } from "../controls/Waiting";
import { ExposureField } from "../controls/ExposureField";
import { EXPOSURE_SLIDERS } from "../../model/settings.gen";
import { Radios } from "../controls/Radios";

const REACH = 4;
const [WIDTH, HEIGHT, MARGIN] = [264, 40, 14];
const MODES: readonly MeterMode[] = ["center", "average", "spot"];
const MODE_NAMES: Readonly<Record<MeterMode, string>> = { center: "Centre", average: "Average", spot: "Spot" };
const LOOKS_AT: Readonly<Record<MeterMode, string>> = {
  center: "The whole picture, its middle most",
  average: "The whole picture alike",
  spot: "One degree, on the selected focus point or in the middle",
};

interface MeterProps {
  readonly session: Session;
  readonly exposure: ExposureSettings;
}

export function LightMeter({ session, exposure }: MeterProps): JSX.Element {
  const meter = session.photography.meter.value;
  const decides = exposure.meteringMode !== "manual";
  const stops = decides ? exposure.meteringCompensationStops : meter?.stops;
  return (
    <div class="meter">
      <Head session={session} exposure={exposure} />
      <div class={isStale(session) ? "meter-read late" : "meter-read"}>
        <Scale stops={meter ? (stops ?? null) : null} />
        <Readings meter={meter} />
      </div>
      <Metering session={session} />
      <Edits session={session}>
        {decides ? (
          <Aim session={session} exposure={exposure} />
        ) : (
          <SetToMeter session={session} exposure={exposure} meter={meter} />
        )}
      </Edits>
    </div>
  );
}

/** Whether what the meter says is of another frame, or of before the last edit. */
function isStale({ photography, playhead, document }: Session): boolean {
  const meter = photography.meter.value;
  return meter?.revision !== document.revision.value || !sameTime(meter.time, playhead.time.value);
}

/** The wait for the meter, or the button that meters after all where that was stopped. */
function Metering({ session }: { session: Session }): JSX.Element | null {
  const wait = session.waits.of("meter");
  if (wait) return <Waiting wait={wait} />;
  if (!isStale(session)) return null;
  if (!session.settled.value)
    return <p class="wait muted">{session.pictures.refusal ?? "The light is metered once the picture is there."}</p>;
  return (
    <p class="wait">
      <span class="muted">Not metered.</span>
      <button
        type="button"
        class="button small"
        onClick={() => {
          session.meter();
        }}
      >
        Meter
      </button>
    </p>
  );
}

/** What it looks at, and whether it decides. */
function Head({ session, exposure }: MeterProps): JSX.Element {
  const { photography } = session;
  const decides = exposure.meteringMode !== "manual";
  const mode = exposure.meteringMode === "manual" ? photography.meterMode.value : exposure.meteringMode;
  const decideBy = (meteringMode: MeterMode): ExposureChange =>
    meteringMode === "spot" ? { meteringMode, meteringFocusPoint: session.selectedName.value ?? "" } : { meteringMode };
  return (
    <div class="meter-head">
      <Radios
        label="What the meter looks at"
        setting="meteringMode"
        values={MODES}
        value={mode}
        names={MODE_NAMES}
        titles={LOOKS_AT}
        isDisabled={() => decides && session.document.noEdits.value !== null}
        onChoose={(choice) => {
          photography.meterMode.value = choice;
          if (decides) photography.setExposure(`Meter: ${MODE_NAMES[choice]}`, decideBy(choice), exposure);
        }}
      />
      <Edits session={session}>
        <label class="switch-row" title="The meter exposes each frame, smoothed over time so that nothing flickers">
          <input
            type="checkbox"
            class="switch"
            checked={decides}
            onChange={({ currentTarget: { checked } }) => {
              const label = checked ? "Expose by the meter" : "Expose by hand";
              photography.setExposure(label, checked ? decideBy(mode) : { meteringMode: "manual" }, exposure);
            }}
          />
          Auto
        </label>
      </Edits>
    </div>
  );
}

/** How much over middle grey a meter that decides exposes. */
function Aim({ session, exposure }: MeterProps): JSX.Element {
  return <ExposureField session={session} exposure={exposure} declared={EXPOSURE_SLIDERS.meteringCompensationStops} />;
}

function SetToMeter({ session, exposure, meter }: MeterProps & { readonly meter: MeterReading | null }): JSX.Element {
  const compensationStops = meter?.compensationStops ?? null;
  return (
    <button
      type="button"
      class="button small"
      disabled={compensationStops === null || Math.abs(compensationStops - exposure.compensationStops) < 0.005}
      title="Sets the compensation so that what is metered becomes middle grey"
      onClick={() => {
        if (compensationStops !== null)
          session.photography.setExposure("Set to the meter", { compensationStops }, exposure);
      }}
    >
      Set to meter
    </button>
  );
}

/** A needle over stops, as in a viewfinder. */
function Scale({ stops }: { stops: number | null }): JSX.Element {
  const x = (value: number): number => WIDTH / 2 + (value / REACH) * (WIDTH / 2 - MARGIN);
  const marks = Array.from({ length: 2 * REACH + 1 }, (_, at) => at - REACH);
  const thirds = marks.slice(0, -1).flatMap((mark) => [mark + 1 / 3, mark + 2 / 3]);
  const text = stops === null ? "not metered yet" : textOf(stops);
  const at = stops === null ? null : x(Math.min(Math.max(stops, -REACH - 0.3), REACH + 0.3));
  return (
    <svg class="meter-scale" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="img" aria-label={`Light meter: ${text}`}>
      {thirds.map((mark) => (
        <line key={mark} class="minor" x1={x(mark)} x2={x(mark)} y1={19} y2={23} />
      ))}
      {marks.map((mark) => (
        <g key={mark}>
          <line x1={x(mark)} x2={x(mark)} y1={mark === 0 ? 12 : 16} y2={23} />
          <text x={x(mark)} y={36} text-anchor="middle">
            {mark === 0 ? "0" : formatStops(mark)}
          </text>
        </g>
      ))}
      {at !== null && <path class="needle" d={`M${at.toFixed(1)} 21l-4.5-11h9z`} />}
      {stops !== null && (
        <text class="meter-said" x={WIDTH - 2} y={9} text-anchor="end">
          {text}
        </text>
      )}
    </svg>
  );
}

function textOf(stops: number): string {
  if (!Number.isFinite(stops)) return "black";
  const rounded = Number(stops.toFixed(1));
  if (rounded === 0) return "on grey";
  return `${Math.abs(rounded).toString()} ${Math.abs(rounded) === 1 ? "stop" : "stops"} ${rounded > 0 ? "over" : "under"}`;
}

function Readings({ meter }: { meter: MeterReading | null }): JSX.Element {
  return (
    <dl class="readout">
      <Reading
        of="meter"
        name="Light"
        value={meter && Number.isFinite(meter.ev100) ? `EV ${trim(meter.ev100, 1)}` : "–"}
      />
      <Reading of="meter" name="Seen" value={meter ? `${amount(meter.luminanceNits)} nits` : "–"} />
      <Reading of="meter" name="Incident" value={meter ? `${amount(meter.incidentLux)} lx` : "–"} />
      <Reading
        of="meter"
        name="Off by"
        value={meter && Number.isFinite(meter.stops) ? formatStops(meter.stops) : "–"}
      />
    </dl>
  );
}

/** Three digits, however large. */
function amount(value: number): string {
  return Number(value.toPrecision(3)).toString();
}
