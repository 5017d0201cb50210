/** What the glass does to the light beside focusing it: how much comes through, how it falls off, and what flares. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import type { ExposureNumber, ExposureSettings } from "../../model/photography";
import { FLARES, SHARES, type Scale } from "../../model/scale";
import { parseQuantity, trim } from "../numbers";
import { Setting } from "../controls/Setting";

interface PartProps {
  readonly session: Session;
  readonly exposure: ExposureSettings;
}

const SWITCHES = [
  ["breathing", "Breathing", "The picture grows with focus as a real lens’s does, and near focus costs light"],
  ["naturalVignetting", "Dark corners", "Ideal lenses fall off by cos⁴; those of glass do so by themselves"],
] as const;

export function GlassPanel({ session, exposure }: PartProps): JSX.Element {
  return (
    <section class="glass" aria-labelledby="glass-title">
      <div class="panel-head">
        <h2 id="glass-title">Glass</h2>
      </div>
      <div class="fields">
        {AMOUNTS.map((amount) => (
          <Amount key={amount.name} {...amount} session={session} exposure={exposure} />
        ))}
        {SWITCHES.map(([name, label, hint]) => (
          <label key={name} class="switch-row" title={hint}>
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
    </section>
  );
}

interface AmountProps {
  readonly name: ExposureNumber;
  readonly label: string;
  readonly hint: string;
  readonly scale: Scale;
  readonly example: string;
  readonly format: (value: number) => string;
  readonly parse: (text: string) => number | null;
}

const STRENGTH = {
  scale: FLARES,
  example: "1×",
  format: (value: number) => (value === 0 ? "off" : `${trim(value, 2)}×`),
  parse: (text: string) => (text.trim() === "off" ? 0 : parseQuantity(text, "×")),
};
const AMOUNTS: readonly AmountProps[] = [
  {
    name: "transmittance",
    label: "Passes",
    hint: "Share of the light that the glass lets through",
    scale: SHARES,
    example: "90 %",
    format: (share) => `${trim(100 * share, 1)} %`,
    parse: (text) => {
      const percent = parseQuantity(text, "%");
      return percent === null ? null : percent / 100;
    },
  },
  {
    ...STRENGTH,
    name: "flareGhosts",
    label: "Ghosts",
    hint: "Reflections between the surfaces of a lens of glass; 1× is as they are. Pictures take longer",
  },
  {
    ...STRENGTH,
    name: "flareStar",
    label: "Star",
    hint: "What the iris diffracts around bright points; 1× is as it is. Pictures take longer",
  },
];

function Amount({ session, exposure, name, ...field }: AmountProps & PartProps): JSX.Element {
  return (
    <Setting
      {...field}
      session={session}
      setting={name}
      keys={exposure.keys}
      value={exposure[name]}
      fresh={session.photography.fresh.value}
      startDrag={() => session.photography.dragExposure(field.label, name, exposure)}
    />
  );
}
