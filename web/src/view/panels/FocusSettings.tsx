/** The settings by which the focus is found: those that its mode uses, and no more. */

import type { ComponentChildren, JSX } from "preact";
import {
  OCCLUDED,
  OFF_SCREEN,
  type FocusSettings,
  type Occluded,
  type OffScreen,
  type Readout,
} from "../../model/shot";
import { Choice, Options } from "../controls/Choice";
import { Reading } from "../controls/Reading";
import { Amount, Switch, type FocusSettingsProps } from "./FocusAmount";
import { trim } from "../numbers";

/** The settings that the mode uses. */
export function ModeSettings({
  session,
  readout,
  settings,
}: FocusSettingsProps & { readonly readout: Readout }): JSX.Element {
  const props = { session, settings };
  const mode = readout.focusMode;
  if (mode === "manual")
    return (
      <More name="Tilt" summary={summaryOfTilt(readout)}>
        <Tilt {...props} />
      </More>
    );
  return (
    <>
      {mode === "tiltPlane" && <TiltPlane {...props} readout={readout} />}
      {mode === "surface" && <Surface {...props} />}
      <Switch
        {...props}
        name="solveStop"
        label="Points set the f-number"
        hint="As wide open as holds all points sharp"
        onEdit={(on) => (on ? "Points set the f-number" : "The f-number by hand")}
      />
      <More name="Smoothing and lag" summary={summaryOfFollow(settings)}>
        <Follow {...props} />
      </More>
      <More name="Which points count" summary={summaryOfCounting(settings)}>
        <Counting {...props} />
      </More>
    </>
  );
}

function TiltPlane({ session, settings, readout }: FocusSettingsProps & { readonly readout: Readout }): JSX.Element {
  const props = { session, settings };
  return (
    <>
      <Switch
        {...props}
        name="drivenByPoints"
        label="Points tilt the lens"
        hint="Off, the angles are yours to set"
        onEdit={(on) => (on ? "Points tilt the lens" : "Tilt by hand")}
      />
      {settings.drivenByPoints ? (
        <>
          <Amount {...props} name="maxAngleDeg" />
          <dl class="readout">
            <Reading of="reading" name="Tilt" value={degrees(readout.tiltDeg)} />
            <Reading of="reading" name="Swing" value={degrees(readout.swingDeg)} />
          </dl>
        </>
      ) : (
        <Tilt {...props} />
      )}
    </>
  );
}

function Tilt(props: FocusSettingsProps): JSX.Element {
  return (
    <>
      <Amount {...props} name="tiltDeg" />
      <Amount {...props} name="swingDeg" />
    </>
  );
}

function Surface(props: FocusSettingsProps): JSX.Element {
  return (
    <>
      <Amount {...props} name="expressive" />
      <Amount {...props} name="surfaceExponent" />
    </>
  );
}

/** An assistant's hand. */
function Follow(props: FocusSettingsProps): JSX.Element {
  return (
    <>
      <Amount {...props} name="smoothingS" />
      <Amount {...props} name="lagS" />
      <Amount {...props} name="deadZoneMm" />
      <Amount {...props} name="nearPriority" />
      <Amount {...props} name="maxSpeedDegS" />
    </>
  );
}

const OFF_SCREEN_NAMES: Readonly<Record<OffScreen, string>> = { ignore: "do not count", keep: "count" };
const OCCLUDED_NAMES: Readonly<Record<Occluded, string>> = {
  keep: "count",
  fade: "fade out",
  ignore: "do not count",
};

/** Which points count, and what is sharp. */
function Counting({ session, settings }: FocusSettingsProps): JSX.Element {
  return (
    <>
      <Choice
        label="Out of frame"
        value={settings.offScreen}
        onChoose={(chosen) => {
          const offScreen = OFF_SCREEN.find((one) => one === chosen) ?? "ignore";
          session.setFocus("Points out of frame", { offScreen }, settings);
        }}
      >
        <Options values={OFF_SCREEN} names={OFF_SCREEN_NAMES} />
      </Choice>
      <Choice
        label="Hidden"
        hint="Points that something stands before"
        value={settings.occluded}
        onChoose={(chosen) => {
          const occluded = OCCLUDED.find((one) => one === chosen) ?? "keep";
          session.setFocus("Hidden points", { occluded }, settings);
        }}
      >
        <Options values={OCCLUDED} names={OCCLUDED_NAMES} />
      </Choice>
      <Amount session={session} settings={settings} name="circleOfConfusionMm" />
    </>
  );
}

/** Settings that are seldom touched, folded away; what they say now is read without opening them. */
function More({
  name,
  summary,
  children,
}: {
  name: string;
  summary: string;
  children: ComponentChildren;
}): JSX.Element {
  return (
    <details class="more">
      <summary>
        {name} <span class="muted">{summary}</span>
      </summary>
      {children}
    </details>
  );
}

function summaryOfFollow({ smoothingS, lagS, deadZoneMm, nearPriority }: FocusSettings): string {
  const parts = [
    smoothingS > 0 && `smoothed over ${trim(smoothingS, 2)} s`,
    lagS > 0 && `${trim(lagS, 2)} s late`,
    deadZoneMm > 0 && `dead zone ${trim(deadZoneMm, 3)} mm`,
    nearPriority > 0 && "near first",
  ].filter((part) => part !== false);
  return parts.join(", ") || "none";
}

function summaryOfCounting({ offScreen, occluded, circleOfConfusionMm }: FocusSettings): string {
  const parts = [
    offScreen === "keep" && "out of frame too",
    occluded === "fade" && "hidden ones fade",
    occluded === "ignore" && "hidden ones do not",
    circleOfConfusionMm > 0 && `sharp to ${trim(circleOfConfusionMm, 3)} mm`,
  ].filter((part) => part !== false);
  return parts.join(", ") || "those in frame";
}

function summaryOfTilt({ tiltDeg, swingDeg }: Readout): string {
  return tiltDeg === 0 && swingDeg === 0 ? "none" : `${degrees(tiltDeg)}, swing ${degrees(swingDeg)}`;
}

function degrees(angle: number): string {
  return `${trim(angle, 1)}°`.replace("-", "−");
}
