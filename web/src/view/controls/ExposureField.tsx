/** A declared number of a camera's exposure: its diamond and its field. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import type { ExposureSettings } from "../../model/photography";
import type { Declared, EXPOSURE_SLIDERS } from "../../model/settings.gen";
import { quantityOf, type Quantity } from "./quantity";
import { Setting } from "./Setting";

/** A number that keys can be set of, as the table of settings declares it. */
export type ExposureSlider = Declared & { readonly name: Exclude<keyof typeof EXPOSURE_SLIDERS, "shutterAngleDeg"> };

interface ExposureFieldProps {
  readonly session: Session;
  readonly exposure: ExposureSettings;
  readonly declared: ExposureSlider;
  /** Parts that are shown or typed in their own way. */
  readonly special?: Partial<Quantity> | undefined;
  readonly disabled?: boolean;
}

export function ExposureField({
  session,
  exposure,
  declared,
  special,
  disabled = false,
}: ExposureFieldProps): JSX.Element {
  const { name, label } = declared;
  return (
    <Setting
      {...quantityOf(declared, special)}
      session={session}
      setting={name}
      keys={exposure.keys}
      value={exposure[name]}
      disabled={disabled}
      fresh={session.photography.fresh.value}
      startDrag={() => session.photography.dragExposure(label, name, exposure)}
    />
  );
}
