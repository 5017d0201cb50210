/**
 * The curve of one keyed value. A drag moves the selected keys in time and value, and the ends of handles; a double click adds a key
 * at its frame, on the curve.
 */

import type { JSX } from "preact";
import { useMemo, useRef } from "preact/hooks";
import type { Session } from "../../editor/session";
import type { LengthUnit } from "../../model/distance";
import { sliderOf } from "../../model/key_lanes";
import type { Key } from "../../model/keys";
import { curveOf, handleAt, valueAt, type Place } from "../../model/spline";
import { sameTime } from "../../model/time";
import { keysOfCurve, valueAxis, type ValueCurve } from "../../model/value_curves";
import { useSize } from "../hooks";
import { PointTracks } from "./CurveChart";
import { Knot } from "./Knot";
import type { TimeAxis } from "./time_axis";
import { handlePlace, isDistance, SIDES, type Plot } from "./value_plot";

interface ValueGraphProps {
  readonly session: Session;
  readonly axis: TimeAxis;
  readonly unit: LengthUnit;
  /** As it is shown, and as the service has it. */
  readonly curve: ValueCurve;
  readonly saved: ValueCurve;
  readonly onScrub: (down: PointerEvent) => void;
}

const STEPS = 24;
const ROW_PX = 26;
/** Selected keys that show their handles: those of more would hide each other. */
const MOST_WITH_HANDLES = 24;

export function ValueGraph({ session, axis, unit, curve, saved, onScrub }: ValueGraphProps): JSX.Element {
  const box = useRef<HTMLDivElement>(null);
  const { height } = useSize(box);
  const plot = usePlot(saved, unit, height, axis);
  const keys = keysOfCurve(curve);
  const selected = session.keys.selected.value;
  const withHandles = curve.keys.filter(({ stack }) => selected.has(stack.id)).length <= MOST_WITH_HANDLES;
  return (
    <div
      class="chart graph"
      role="group"
      aria-label={`Curve of ${curve.label}`}
      ref={box}
      onPointerDown={onScrub}
      onDblClick={(event) => {
        addKey(session, plot, curve, event);
      }}
    >
      {height > 0 && (
        <>
          <svg width={axis.width} height={height} aria-hidden="true">
            <clipPath id="graph-clip">
              <rect x={axis.left} y={-8} width={axis.right - axis.left} height={height + 16} />
            </clipPath>
            <Marks plot={plot} />
            <g clip-path="url(#graph-clip)">
              {isDistance(curve.owner) && (
                <PointTracks session={session} curve={session.document.curve.value} plot={plot} right={axis.right} />
              )}
              <path class="value-line" d={lineOf(keys.length > 0 ? curveOf(keys, STEPS) : [], plot)} />
              {curve.keys.map(
                ({ stack }, index) =>
                  withHandles && selected.has(stack.id) && <Arms key={index} plot={plot} keys={keys} index={index} />,
              )}
            </g>
          </svg>
          {curve.keys.map((entry, index) => (
            <Knot
              key={entry.place}
              session={session}
              plot={plot}
              curve={curve}
              keys={keys}
              index={index}
              entry={entry}
              unit={unit}
              withHandles={withHandles}
            />
          ))}
        </>
      )}
    </div>
  );
}

/** The vertical axis is of what is shown, and stays as it is while keys are dragged. */
function usePlot(saved: ValueCurve, unit: LengthUnit, height: number, axis: TimeAxis): Plot {
  return useMemo<Plot>(() => {
    const all = keysOfCurve(saved);
    const [from, to] = [valueAt(all, axis.span.start), valueAt(all, axis.span.end)];
    const shown = all.flatMap((key) => (axis.has(key.time) ? [key.value] : []));
    const ends = all.flatMap((_, index) => SIDES.map((side) => handleAt(all, index, side)));
    const more = ends.flatMap((end) =>
      end && axis.has(end.time) && (sliderOf(saved.owner)?.scale === "linear" || end.value > 0) ? [end.value] : [],
    );
    const keyed = [...shown, from, to].filter((value) => value !== null);
    const values = valueAxis(saved, more, unit, Math.max(2, Math.floor(height / ROW_PX)), keyed);
    const held = (fraction: number): number => Math.min(Math.max(fraction, -1), 2);
    return { time: axis, axis: values, height, x: axis.x, y: (value) => (1 - held(values.fraction(value))) * height };
  }, [saved, unit, height, axis]);
}

function Marks({ plot }: { plot: Plot }): JSX.Element {
  return (
    <g class="grid">
      {plot.axis.ticks.map(({ value, label }) => (
        <g key={value} transform={`translate(0 ${plot.y(value).toFixed(1)})`}>
          <line x1={plot.time.left} x2={plot.time.right} />
          <text x={plot.time.left - 10} y={4} text-anchor="end">
            {label}
          </text>
        </g>
      ))}
    </g>
  );
}

/** The curve, level before its first key and after its last. */
function lineOf(places: readonly Place[], plot: Plot): string {
  const [first, last] = [places[0], places.at(-1)];
  if (!first || !last) return "";
  const at = ({ time, value }: Place): string => `${plot.x(time).toFixed(1)} ${plot.y(value).toFixed(1)}`;
  return `M${plot.time.left} ${plot.y(first.value).toFixed(1)}L${places.map(at).join("L")}H${plot.time.right}`;
}

/** Lines from a key to the ends of its handles. */
function Arms({ plot, keys, index }: { plot: Plot; keys: readonly Key[]; index: number }): JSX.Element {
  const key = keys[index];
  const lines = SIDES.flatMap((side) => {
    const end = handleAt(keys, index, side);
    if (!key || !end) return [];
    const { x, y } = handlePlace(plot, key, end, side);
    return [`M${plot.x(key.time)} ${plot.y(key.value)}L${x} ${y}`];
  });
  return <path class="arms" d={lines.join("")} />;
}

/** Adds a key to a curve at the frame of a double click; selects one that is there. */
function addKey(session: Session, plot: Plot, curve: ValueCurve, event: MouseEvent): void {
  const keys = keysOfCurve(curve);
  const left = (event.currentTarget as HTMLElement).getBoundingClientRect().left;
  const time = plot.time.time(event.clientX - left);
  const isBeside = event.clientX - left < plot.time.left || event.clientX - left > plot.time.right;
  if (isBeside || event.target instanceof HTMLButtonElement) return;
  const there = curve.keys.find(({ owned }) => sameTime(owned.key.time, time));
  if (there) {
    session.keys.select([there.stack]);
    return;
  }
  void session.keys.add(curve.owner, keys, time);
}
