/** The chosen take over the focus curve, its few keys, and the frames between which is recorded. */

import type { JSX } from "preact";
import type { RingDesk } from "../../editor/ring_desk";
import { curveOf } from "../../model/spline";
import { samplesOf } from "../../model/take";
import type { TimeAxis } from "./time_axis";

interface TakeLineProps {
  readonly desk: RingDesk;
  readonly axis: TimeAxis;
  readonly y: (distanceM: number) => number;
  readonly height: number;
}

/** Places in one curved segment. */
const STEPS = 24;

export function TakeLine({ desk, axis, y, height }: TakeLineProps): JSX.Element {
  const simplified = desk.simplified.value;
  const { punchIn, punchOut } = desk.notes.value;
  const line = (places: readonly (readonly [number, number])[]): string =>
    places.map(([time, distanceM]) => `${axis.x(time).toFixed(1)} ${y(distanceM).toFixed(1)}`).join("L");
  return (
    <g class="take">
      {[punchIn, punchOut].map(
        (time) =>
          time !== null && <line key={time} class="punch-at" x1={axis.x(time)} x2={axis.x(time)} y1={0} y2={height} />,
      )}
      {simplified && (
        <>
          <path
            class="take-line"
            d={`M${line(samplesOf(simplified.take).map(({ time, distanceM }) => [time, distanceM] as const))}`}
          />
          <path
            class="take-fit"
            d={`M${line(curveOf(simplified.keys, STEPS).map(({ time, value }) => [time, value] as const))}`}
          />
          {simplified.keys.map(({ time, value }) => (
            <circle key={time} cx={axis.x(time)} cy={y(value)} r={3} />
          ))}
        </>
      )}
    </g>
  );
}
