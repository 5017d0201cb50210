/** What the glass does to the light beside focusing it: how much comes through, how it falls off, and what flares. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import type { ExposureSettings } from "../../model/photography";
import { EXPOSURE_SLIDERS } from "../../model/settings.gen";
import { ExposureField, type ExposureSlider } from "../controls/ExposureField";
import { Section } from "./Section";

interface PartProps {
  readonly session: Session;
  readonly exposure: ExposureSettings;
}

const AMOUNTS = Object.values(EXPOSURE_SLIDERS).filter(({ panel }) => panel === "glass") as readonly ExposureSlider[];
const SWITCHES = [
  ["breathing", "Breathing", "The picture grows with focus as a real lens’s does, and near focus costs light"],
  ["naturalVignetting", "Dark corners", "Ideal lenses fall off by cos⁴; those of glass do so by themselves"],
] as const;

export function GlassPanel({ session, exposure }: PartProps): JSX.Element {
  return (
    <Section name="glass" title="Glass">
      <div class="fields">
        {AMOUNTS.map((declared) => (
          <ExposureField key={declared.name} session={session} exposure={exposure} declared={declared} />
        ))}
        {SWITCHES.map(([name, label, hint]) => (
          <label key={name} class="switch-row" title={hint} data-setting={name}>
            <input
              type="checkbox"
              class="switch"
              checked={exposure[name]}
              onChange={({ currentTarget: { checked } }) => {
                session.photography.setExposure(label, { [name]: checked }, exposure);
              }}
            />
            {label}
          </label>
        ))}
      </div>
    </Section>
  );
}
