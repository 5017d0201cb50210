/** Scopes of the picture on screen, below it. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { SCOPES, type Figures, type Scope } from "../../model/scopes";
import { Icon } from "../icons";
import { useCounted, type Counted } from "./counted";
import { Histogram } from "./Histogram";
import { Parade, Vectorscope, Waveform } from "./traces";

const NAMES: Readonly<Record<Scope, string>> = {
  histogram: "Histogram",
  waveform: "Waveform",
  parade: "Parade",
  vectorscope: "Vectorscope",
};
const TITLES: Readonly<Record<Scope, string>> = {
  histogram: "How many pixels are how bright: red, green, blue and luma",
  waveform: "Luma of each column of the picture",
  parade: "Red, green and blue of each column of the picture",
  vectorscope: "Hue and saturation of the pixels",
};
const DRAWN: Readonly<Record<Scope, (props: Counted) => JSX.Element>> = {
  histogram: Histogram,
  waveform: Waveform,
  parade: Parade,
  vectorscope: Vectorscope,
};

export function ScopesPanel({ editor: { remembered }, session }: { editor: Editor; session: Session }): JSX.Element {
  const counted = useCounted(session);
  const { chosenScopes, scopes } = remembered;
  const { time, revision, stage } = counted?.of ?? {};
  return (
    <section
      class="scopes"
      aria-label="Scopes"
      data-time={time}
      data-revision={revision}
      data-stage={stage}
      data-width={counted?.width}
    >
      <header class="scopes-head">
        <h2>Scopes</h2>
        <div class="group" role="group" aria-label="Scopes that are shown">
          {SCOPES.map((scope) => (
            <button
              key={scope}
              type="button"
              class="button small"
              aria-pressed={chosenScopes.has(scope)}
              title={TITLES[scope]}
              onClick={() => {
                chosenScopes.toggle(scope);
              }}
            >
              {NAMES[scope]}
            </button>
          ))}
        </div>
        {counted && <FiguresLine figures={counted.figures} />}
        <button
          type="button"
          class="button icon-only quiet"
          aria-label="Close the scopes"
          title="Close the scopes (Shift H)"
          onClick={() => (scopes.value = "off")}
        >
          <Icon name="close" />
        </button>
      </header>
      <div class="scopes-row">
        {SCOPES.filter((scope) => chosenScopes.has(scope)).map((scope) => {
          const Drawn = DRAWN[scope];
          return counted && <Drawn key={scope} {...counted} />;
        })}
      </div>
    </section>
  );
}

/** The picture in numbers. */
function FiguresLine({ figures: { mean, low, high } }: { figures: Figures }): JSX.Element {
  return (
    <p class="scopes-figures numbers" title="Of the display values; a pixel is clipped where one of its channels is">
      <span>
        mean luma <b data-figure="mean">{percent(mean)}</b>
      </span>
      <span>
        clipped at 0 % <b data-figure="low">{percent(low)}</b>
      </span>
      <span>
        at 100 % <b data-figure="high">{percent(high)}</b>
      </span>
    </p>
  );
}

function percent(share: number): string {
  return `${(100 * share).toFixed(1)} %`;
}
