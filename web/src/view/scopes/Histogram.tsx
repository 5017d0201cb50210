/** How many pixels there are at each level. */

import type { JSX } from "preact";
import { useMemo } from "preact/hooks";
import { CHANNELS, histogramOf, LEVELS, outlineOf, peakOf } from "../../model/scopes";
import type { Counted } from "./counted";
import { Scale } from "./Scale";

export function Histogram({ planes }: Counted): JSX.Element {
  const histograms = useMemo(() => CHANNELS.map((channel) => histogramOf(planes[channel])), [planes]);
  return (
    <figure class="scope across">
      <div class="scope-plot" role="img" aria-label="Histogram of red, green, blue and luma">
        <svg viewBox={`0 0 ${LEVELS} ${peakOf(histograms)}`} preserveAspectRatio="none" aria-hidden="true">
          {histograms.map((counts, at) => (
            <path key={at} class={`of-${CHANNELS[at]}`} data-channel={CHANNELS[at]} d={outlineOf(counts)} />
          ))}
        </svg>
      </div>
      <Scale />
    </figure>
  );
}
