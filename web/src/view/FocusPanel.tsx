/** How the focus is found: by whom, with what settings, and why it is where it is. */

import type { ComponentChildren, JSX } from "preact";
import type { Session } from "../editor/session";
import {
  FOCUS_ANGLES_DEG,
  FOLLOW_S,
  DEAD_ZONES_MM,
  EXPONENTS,
  NEAR_PRIORITIES,
  SHARES,
  TILTS_DEG,
} from "../model/scale";
import { FOCUS_MODES, type FocusMode, type FocusNumber, type FocusSettings, type Readout } from "../model/shot";
import { Field, type FieldProps } from "./Field";
import { parseQuantity, trim } from "./numbers";

const MODES: Readonly<Record<FocusMode, readonly [name: string, does: string]>> = {
  manual: ["By hand", "The focus distance is yours to set and to key"],
  points: ["Points", "One distance, the best for all focus points"],
  tiltPlane: ["Tilt plane", "The lens tilts so that its plane of focus passes through the points"],
  surface: ["Surface", "Each point has its own focus, and the picture runs smoothly between them: no lens does this"],
};

export function FocusPanel({ session }: { session: Session }): JSX.Element | null {
  const readout = session.document.readout.value;
  const settings = session.document.focusSettings.value;
  if (!readout || !settings) return null;
  return (
    <section class="focus" aria-labelledby="focus-title">
      <div class="panel-head">
        <h2 id="focus-title">Focus</h2>
      </div>
      <div class="fields">
        <ModeChooser session={session} mode={readout.focusMode} />
        <p class="reason" title={readout.reason}>
          {readout.reason}
        </p>
        {readout.note !== "" && (
          <p class="reason remark" role="status">
            {readout.note}
          </p>
        )}
        <ModeSettings session={session} readout={readout} settings={settings} />
      </div>
    </section>
  );
}

function ModeChooser({ session, mode }: { session: Session; mode: FocusMode }): JSX.Element {
  return (
    <div class="group modes" role="radiogroup" aria-label="Who focuses">
      {FOCUS_MODES.map((choice) => (
        <button
          key={choice}
          type="button"
          class="button small"
          role="radio"
          aria-checked={mode === choice}
          title={MODES[choice][1]}
          onClick={() => {
            session.setFocusMode(choice);
          }}
        >
          {MODES[choice][0]}
        </button>
      ))}
    </div>
  );
}

interface SettingsProps {
  readonly session: Session;
  readonly settings: FocusSettings;
}

/** What the mode uses, and no more. */
function ModeSettings({ session, readout, settings }: SettingsProps & { readonly readout: Readout }): JSX.Element {
  const props = { session, settings };
  const mode = readout.focusMode;
  if (mode === "manual")
    return (
      <More name="Tilt" said={saidOfTilt(readout)}>
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
      <More name="Follow" said={saidOfFollow(settings)}>
        <Follow {...props} />
      </More>
    </>
  );
}

function TiltPlane({ session, settings, readout }: SettingsProps & { readonly readout: Readout }): JSX.Element {
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
          <Setting {...props} name="maxAngleDeg" label="Largest angle" scale={FOCUS_ANGLES_DEG} unit="°" />
          <dl class="readout">
            <div>
              <dt>Tilt</dt>
              <dd data-reading="tilt">{degrees(readout.tiltDeg)}</dd>
            </div>
            <div>
              <dt>Swing</dt>
              <dd data-reading="swing">{degrees(readout.swingDeg)}</dd>
            </div>
          </dl>
        </>
      ) : (
        <Tilt {...props} />
      )}
    </>
  );
}

function Tilt(props: SettingsProps): JSX.Element {
  return (
    <>
      <Setting {...props} name="tiltDeg" label="Tilt" hint="Above 0 the lens looks up" scale={TILTS_DEG} unit="°" />
      <Setting {...props} name="swingDeg" label="Swing" hint="Above 0 it looks left" scale={TILTS_DEG} unit="°" />
    </>
  );
}

function Surface(props: SettingsProps): JSX.Element {
  return (
    <>
      <Setting
        {...props}
        name="expressive"
        label="Expressive"
        hint="From what a lens does (0 %) to the whole surface (100 %)"
        scale={SHARES}
        unit=" %"
        per={0.01}
      />
      <Setting
        {...props}
        name="surfaceExponent"
        label="Locality"
        hint="How near to itself each point rules: from 2, wide and soft, to 4, close"
        scale={EXPONENTS}
        unit=""
        places={1}
      />
    </>
  );
}

/** An assistant's hand. */
function Follow(props: SettingsProps): JSX.Element {
  return (
    <>
      <Setting
        {...props}
        name="smoothingS"
        label="Smoothing"
        hint="Time over which focus is smoothed; exact at keys"
        scale={FOLLOW_S}
        unit=" s"
        places={2}
      />
      <Setting {...props} name="lagS" label="Lag" hint="How late focus follows" scale={FOLLOW_S} unit=" s" places={2} />
      <Setting
        {...props}
        name="deadZoneMm"
        label="Dead zone"
        hint="Blur on the film that a point may get before the focus moves"
        scale={DEAD_ZONES_MM}
        unit=" mm"
        places={3}
      />
      <Setting
        {...props}
        name="nearPriority"
        label="Near priority"
        hint="How much nearer points count more; 0 not at all"
        scale={NEAR_PRIORITIES}
        unit=""
        places={1}
      />
    </>
  );
}

/** Settings that are seldom touched, folded away; what they say now is read without opening them. */
function More({ name, said, children }: { name: string; said: string; children: ComponentChildren }): JSX.Element {
  return (
    <details class="more">
      <summary>
        {name} <span class="muted">{said}</span>
      </summary>
      {children}
    </details>
  );
}

interface SettingProps extends SettingsProps {
  readonly name: FocusNumber;
  readonly label: string;
  readonly hint?: string;
  readonly scale: FieldProps["scale"];
  /** With the space that stands before it. */
  readonly unit: string;
  /** What one of the unit is. */
  readonly per?: number;
  readonly places?: number;
}

function Setting({
  session,
  settings,
  name,
  label,
  hint,
  scale,
  unit,
  per = 1,
  places = 0,
}: SettingProps): JSX.Element {
  const format = (value: number): string => `${trim(value / per, places)}${unit}`;
  const isSigned = scale.min < 0;
  return (
    <Field
      label={label}
      {...(hint === undefined ? {} : { hint })}
      value={settings[name]}
      scale={scale}
      fresh={session.document.fresh.value}
      example={format(scale.max / 2)}
      format={format}
      parse={(text) => {
        const value = parseQuantity(text, unit.trim());
        return value === null || (value < 0 && !isSigned) ? null : value * per;
      }}
      startDrag={() => session.dragFocus(label.toLowerCase(), name, settings)}
    />
  );
}

interface SwitchProps extends SettingsProps {
  readonly name: "solveStop" | "drivenByPoints";
  readonly label: string;
  readonly hint: string;
  /** What the edit is called. */
  readonly onEdit: (on: boolean) => string;
}

function Switch({ session, settings, name, label, hint, onEdit }: SwitchProps): JSX.Element {
  return (
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
  );
}

function saidOfFollow({ smoothingS, lagS, deadZoneMm, nearPriority }: FocusSettings): string {
  const said = [
    smoothingS > 0 && `smoothed over ${trim(smoothingS, 2)} s`,
    lagS > 0 && `${trim(lagS, 2)} s late`,
    deadZoneMm > 0 && `dead zone ${trim(deadZoneMm, 3)} mm`,
    nearPriority > 0 && "near first",
  ].filter((part) => part !== false);
  return said.join(", ") || "at once";
}

function saidOfTilt({ tiltDeg, swingDeg }: Readout): string {
  return tiltDeg === 0 && swingDeg === 0 ? "none" : `${degrees(tiltDeg)}, swing ${degrees(swingDeg)}`;
}

function degrees(angle: number): string {
  return `${trim(angle, 1)}°`.replace("-", "−");
}
