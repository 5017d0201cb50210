/** Depth from the lens to infinity on a reciprocal scale, as on a lens barrel: what is sharp, and where the points are. */

import type { JSX } from "preact";
import { axisFraction, distanceAxis, formatDistance, formatMark, type LengthUnit } from "../../model/distance";
import type { FocusPoint, Readout } from "../../model/shot";

interface DepthStripProps {
  readonly readout: Readout;
  readonly points: readonly FocusPoint[];
  readonly selected: string | null;
  readonly unit: LengthUnit;
}

export function DepthStrip({ readout, points, selected, unit }: DepthStripProps): JSX.Element {
  const placed = points.filter((point): point is FocusPoint & { depthM: number } => (point.depthM ?? 0) > 0);
  const axis = distanceAxis(
    [readout.focusDistanceM, readout.nearM, readout.farM, ...placed.map((point) => point.depthM)],
    unit,
    5,
  );
  const at = (distanceM: number): string => `${Math.min(Math.max(axisFraction(axis, distanceM), 0), 1) * 100}%`;
  const [near, far] = [at(readout.nearM), at(readout.farM)];
  return (
    <div
      class="strip"
      role="img"
      aria-label={`Sharp from ${formatDistance(readout.nearM, unit)} to ${formatDistance(readout.farM, unit)}`}
    >
      <div class="strip-track">
        <div class="strip-band" style={{ left: near, width: `calc(${far} - ${near})` }} />
        {placed.map((point) => (
          <div
            key={point.name}
            title={`${point.name}, ${formatDistance(point.depthM, unit)}`}
            class={`strip-point${point.name === selected ? " selected" : ""}`}
            style={{ left: at(point.depthM) }}
          />
        ))}
        <div class="strip-focus" style={{ left: at(readout.focusDistanceM) }} />
      </div>
      {axis.ticks.map((tick) => (
        <span key={tick} class="strip-tick" style={{ left: at(tick) }}>
          {formatMark(tick, unit)}
        </span>
      ))}
    </div>
  );
}
