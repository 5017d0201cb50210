/** The focus curve: distance upwards on a reciprocal axis, with the band that is sharp and the points' own depths. */

import type { JSX } from "preact";
import { useMemo, useRef } from "preact/hooks";
import type { Session } from "../../editor/session";
import { distancesOf, pointNames, sampleAt, type Curve, type CurveSample } from "../../model/curve";
import {
  axisFraction,
  distanceAxis,
  formatDistance,
  formatMark,
  type DistanceAxis,
  type LengthUnit,
} from "../../model/distance";
import { samplesOf } from "../../model/take";
import { Waiting } from "../controls/Waiting";
import { useSize } from "../hooks";
import { TakeLine } from "./TakeLine";
import type { TimeAxis } from "./time_axis";

interface CurveChartProps {
  readonly session: Session;
  readonly axis: TimeAxis;
  readonly unit: LengthUnit;
  readonly onScrub: (down: PointerEvent) => void;
}

/** Places of the chart, CSS px. */
interface Plot {
  readonly x: (time: number) => number;
  readonly y: (distanceM: number) => number;
  readonly height: number;
}

export function CurveChart({ session, axis, unit, onScrub }: CurveChartProps): JSX.Element {
  const box = useRef<HTMLDivElement>(null);
  const { height } = useSize(box);
  const curve = session.document.curve.value;
  const isRingShown = session.desk.choices.shown.value === "on";
  const take = isRingShown ? session.desk.take.value : null;
  const ofTake = useMemo(() => (take ? samplesOf(take).map(({ distanceM }) => distanceM) : []), [take]);
  const distances = useMemo(
    () => distanceAxis([...distancesOf(curve), ...ofTake], unit, Math.max(2, Math.floor(height / 26))),
    [curve, ofTake, unit, height],
  );
  const plot = useMemo<Plot>(
    () => ({ x: axis.x, y: (d) => (1 - Math.min(Math.max(axisFraction(distances, d), -1), 2)) * height, height }),
    [axis, distances, height],
  );
  return (
    <div class="chart" ref={box} onPointerDown={onScrub}>
      <CurveHint session={session} left={axis.left} />
      {height > 0 && curve.length > 0 && (
        <svg width={axis.width} height={height} role="img" aria-label={describe(curve, unit)}>
          <clipPath id="plot-clip">
            <rect x={axis.left} y={0} width={axis.right - axis.left} height={height} />
          </clipPath>
          <Grid axis={axis} distances={distances} plot={plot} unit={unit} />
          <g clip-path="url(#plot-clip)">
            <Band curve={curve} plot={plot} />
            <PointTracks session={session} curve={curve} plot={plot} right={axis.right} />
            <FocusLine curve={curve} plot={plot} />
            {isRingShown && <TakeLine desk={session.desk} axis={axis} y={plot.y} height={height} />}
          </g>
          {axis.has(session.playhead.time.value) && <NowDot session={session} plot={plot} />}
        </svg>
      )}
    </div>
  );
}

/** What there is to wait for: a curve, or the one after the last edit. */
function CurveHint({ session, left }: { session: Session; left: number }): JSX.Element | null {
  const { document, waits } = session;
  const wait = waits.of("curve");
  if (document.hasLens && !wait && document.solved.revision.value === document.revision.value) return null;
  const isStopped = document.pending.value === 0 && !document.dragging.value;
  return (
    <p
      class="chart-hint muted"
      style={{ left: `${left + 8}px` }}
      onPointerDown={(event) => {
        event.stopPropagation();
      }}
    >
      {!document.hasLens ? (
        "No camera, no focus curve."
      ) : wait ? (
        <Waiting wait={wait} />
      ) : (
        isStopped && (
          <>
            {document.curve.value.length > 0 ? "The focus curve of before the last edit." : "No focus curve yet."}{" "}
            <button
              type="button"
              class="button small"
              onClick={() => {
                document.refreshCurve(document.revision.peek());
              }}
            >
              Solve it
            </button>
          </>
        )
      )}
    </p>
  );
}

function describe(curve: Curve, unit: LengthUnit): string {
  const [first, last] = [curve[0], curve.at(-1)];
  if (!first || !last) return "Focus curve, not there yet";
  return `Focus curve from ${formatDistance(first.focusDistanceM, unit)} at the first frame to ${formatDistance(last.focusDistanceM, unit)} at the last`;
}

function Grid({
  axis,
  distances,
  plot,
  unit,
}: {
  axis: TimeAxis;
  distances: DistanceAxis;
  plot: Plot;
  unit: LengthUnit;
}): JSX.Element {
  return (
    <g class="grid">
      {distances.ticks.map((tick) => (
        <g key={tick} transform={`translate(0 ${plot.y(tick).toFixed(1)})`}>
          <line x1={axis.left} x2={axis.right} />
          <text x={axis.left - 10} y={4} text-anchor="end">
            {formatMark(tick, unit)}
            {unit === "m" && Number.isFinite(tick) ? " m" : ""}
          </text>
        </g>
      ))}
    </g>
  );
}

/** From the near limit forth and along the far limit back. */
function Band({ curve, plot }: { curve: Curve; plot: Plot }): JSX.Element {
  const line = (samples: readonly CurveSample[], limit: "nearM" | "farM"): string[] =>
    samples.map((sample) => `${plot.x(sample.time).toFixed(1)} ${plot.y(sample[limit]).toFixed(1)}`);
  const outline = [...line(curve, "nearM"), ...line(curve.toReversed(), "farM")];
  return <path class="band" d={outline.length > 2 ? `M${outline.join("L")}Z` : ""} />;
}

function FocusLine({ curve, plot }: { curve: Curve; plot: Plot }): JSX.Element {
  return (
    <path
      class="focus-line"
      d={polyline(
        curve.map((sample) => [sample.time, sample.focusDistanceM]),
        plot,
      )}
    />
  );
}

interface PointTracksProps {
  readonly session: Session;
  readonly curve: Curve;
  readonly plot: Plot;
  readonly right: number;
}

/** The depths of the focus points over time, dotted. */
export function PointTracks({ session, curve, plot, right }: PointTracksProps): JSX.Element {
  const [selected, colors] = [session.selected.value, session.pointColors.value];
  const tracks = useMemo(
    () =>
      pointNames(curve).map((name) => ({
        name,
        depths: curve.map((sample): Track[number] => [
          sample.time,
          sample.points.find((p) => p.name === name)?.depthM ?? null,
        ]),
      })),
    [curve],
  );
  const labels = labelPlaces(tracks, plot, selected, right);
  return (
    <>
      {tracks.map(({ name, depths }) => (
        <g key={name} class={name === selected ? "track selected" : "track"} data-color={colors.get(name)}>
          <path d={polyline(depths, plot)} />
          {labels.has(name) && (
            <text x={right - 6} y={labels.get(name)} text-anchor="end">
              {name}
            </text>
          )}
        </g>
      ))}
    </>
  );
}

type Track = readonly [time: number, depthM: number | null][];

/** Where the names of the tracks stand at their ends; the selected first, and none that would cover another. */
function labelPlaces(
  tracks: readonly { name: string; depths: Track }[],
  plot: Plot,
  selected: string | null,
  right: number,
): Map<string, number> {
  const places = new Map<string, number>();
  const first = tracks.toSorted((a, b) => Number(b.name === selected) - Number(a.name === selected));
  for (const { name, depths } of first) {
    const end = depths.findLast(([time]) => plot.x(time) <= right + 0.5)?.[1] ?? 0;
    const above = plot.y(end) - 5;
    const y = above < 12 ? above + 18 : above;
    if (end > 0 && [...places.values()].every((other) => Math.abs(other - y) > 11)) places.set(name, y);
  }
  return places;
}

/** A line through what exists, broken where it does not. */
function polyline(places: readonly (readonly [number, number | null])[], plot: Plot): string {
  let pen = "M";
  let line = "";
  for (const [time, distanceM] of places) {
    if (distanceM === null || distanceM <= 0) {
      pen = "M";
      continue;
    }
    line += `${pen}${plot.x(time).toFixed(1)} ${plot.y(distanceM).toFixed(1)}`;
    pen = "L";
  }
  return line;
}

function NowDot({ session, plot }: { session: Session; plot: Plot }): JSX.Element | null {
  const sample = sampleAt(session.document.curve.value, session.playhead.time.value);
  if (!sample) return null;
  return (
    <circle
      class="now"
      cx={plot.x(sample.time)}
      cy={Math.min(Math.max(plot.y(sample.focusDistanceM), 0), plot.height)}
      r={4}
    />
  );
}
