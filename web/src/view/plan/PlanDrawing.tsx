/** The lines of the set from above: grid, field of view, what is sharp, the ways of the points, and how far they are off the focus. */

import type { JSX } from "preact";
import { useMemo } from "preact/hooks";
import type { Session } from "../../editor/session";
import type { LengthUnit } from "../../model/distance";
import { KEYED_ATTRIBUTES, keysOf, type FocusPoint } from "../../model/shot";
import {
  edgesOf,
  gridOf,
  leastWOf,
  lineOf,
  placeOnPath,
  residualOf,
  toPlan,
  toSheet,
  wedgeOf,
  type CutLine,
  type Paths,
  type Place,
  type Sheet,
  type TopView,
} from "../../model/top_view";
import type { Vector } from "../../model/vector";
import { inFrontOf, type PlanPoint } from "./points";

interface DrawingProps {
  readonly session: Session;
  readonly sheet: Sheet;
  readonly view: TopView;
  readonly points: readonly PlanPoint[];
  readonly unit: LengthUnit;
}

export function PlanDrawing({ session, sheet, view, points, unit }: DrawingProps): JSX.Element {
  const leastW = leastWOf(sheet, view);
  const [x, y] = toSheet(sheet, [0, 0]);
  const paths = session.topView.paths.value;
  return (
    <svg
      class="plan-lines"
      width={sheet.width}
      height={sheet.height}
      aria-hidden="true"
      data-px-per-m={sheet.pxPerM}
      data-camera-x={x}
      data-camera-y={y}
    >
      <GridLines sheet={sheet} unit={unit} />
      <path class="plan-wedge" d={outline(sheet, wedgeOf(view, leastW))} />
      {edgesOf(view, leastW).map((edge, at) => (
        <path key={at} class="plan-edge" d={line(sheet, edge)} />
      ))}
      <path
        class="plan-axis"
        d={line(sheet, [
          [0, 0],
          [0, 1 / leastW - view.setBackM],
        ])}
      />
      {CUT_LINES.map((name) => (
        <path
          key={name}
          class={`plan-cut ${name}`}
          d={lineOf(view, name, leastW)
            .map((piece) => line(sheet, piece))
            .join("")}
        />
      ))}
      {paths && <Ways session={session} sheet={sheet} view={view} paths={paths} />}
      {points.map((point) => (
        <Residual key={point.name} sheet={sheet} view={view} point={point} leastW={leastW} />
      ))}
      <CameraSign sheet={sheet} view={view} />
    </svg>
  );
}

const CUT_LINES: readonly CutLine[] = ["nearW", "farW", "focusW"];

function spot(sheet: Sheet, at: Place): string {
  return toSheet(sheet, at)
    .map((px) => px.toFixed(2))
    .join(" ");
}

function line(sheet: Sheet, places: readonly Place[]): string {
  return places.length > 0 ? `M${places.map((at) => spot(sheet, at)).join("L")}` : "";
}

function outline(sheet: Sheet, places: readonly Place[]): string {
  return places.length > 0 ? `${line(sheet, places)}Z` : "";
}

/** Squares that are counted from the camera, with the depths along the left edge. */
function GridLines({ sheet, unit }: { sheet: Sheet; unit: LengthUnit }): JSX.Element {
  const { rights, depths } = useMemo(() => gridOf(sheet, unit, GRID_PX), [sheet, unit]);
  const [left, right] = [rights[0] ?? 0, rights.at(-1) ?? 0];
  const [low, high] = [depths[0] ?? 0, depths.at(-1) ?? 0];
  const step = (depths[1] ?? 1) - (depths[0] ?? 0);
  const ends = [left - step, right + step, low - step, high + step] as const;
  return (
    <g class="plan-grid">
      {depths.map((depth) => (
        <path
          key={`d${depth}`}
          d={line(sheet, [
            [ends[0], depth],
            [ends[1], depth],
          ])}
        />
      ))}
      {rights.map((along) => (
        <path
          key={`r${along}`}
          d={line(sheet, [
            [along, ends[2]],
            [along, ends[3]],
          ])}
        />
      ))}
    </g>
  );
}

export const GRID_PX = 48;

/** The ways of the points over the shot, with their keys, and that of the camera. */
function Ways({
  session,
  sheet,
  view,
  paths,
}: Pick<DrawingProps, "session" | "sheet" | "view"> & { paths: Paths }): JSX.Element {
  const points = session.document.points.value;
  const colors = session.pointColors.value;
  return (
    <g class="plan-ways">
      <path class="plan-way of-camera" d={wayOf(sheet, view, paths.cameraM)} />
      {paths.points.map(({ name, positionsM }) => {
        const point = points.find((one) => one.name === name);
        return (
          <g key={name} data-color={colors.get(name)} class={session.selected.value === name ? "selected" : ""}>
            <path class="plan-way" data-way={name} d={wayOf(sheet, view, positionsM)} />
            {point &&
              keyTimes(point).map((time) => {
                const at = placeOnPath(paths, positionsM, time);
                return at && <path key={time} class="plan-key" d={diamond(sheet, toPlan(view, at))} />;
              })}
          </g>
        );
      })}
    </g>
  );
}

function wayOf(sheet: Sheet, view: TopView, positions: readonly (Vector | null)[]): string {
  let [pen, drawn] = ["M", ""];
  for (const at of positions) {
    if (at) drawn += `${pen}${spot(sheet, toPlan(view, at))}`;
    pen = at ? "L" : "M";
  }
  return drawn;
}

function keyTimes(point: FocusPoint): number[] {
  return [...new Set(KEYED_ATTRIBUTES.flatMap((attribute) => keysOf(point, attribute)).map(({ time }) => time))];
}

function diamond(sheet: Sheet, at: Place): string {
  const [x, y] = toSheet(sheet, at);
  return `M${x.toFixed(2)} ${(y - 4).toFixed(2)}l4 4l-4 4l-4 -4Z`;
}

/** From a point along its ray to the focus. */
function Residual({
  sheet,
  view,
  point,
  leastW,
}: Pick<DrawingProps, "sheet" | "view"> & { point: PlanPoint; leastW: number }): JSX.Element | null {
  if (point.focusDistanceM === null || !inFrontOf(view, point.place)) return null;
  const [from, to] = residualOf(view, point.place, point.focusDistanceM, leastW);
  return (
    <path
      class={`plan-residual${point.isSharp ? " sharp" : ""}`}
      data-residual={point.name}
      d={line(sheet, [from, to])}
    />
  );
}

/** The camera: its body behind the pupil, the gate across it, and the lens before it, not to scale. */
function CameraSign({ sheet, view }: Pick<DrawingProps, "sheet" | "view">): JSX.Element {
  const [x, y] = toSheet(sheet, [0, 0]);
  const [left, right] = view.edges;
  const wide = (slope: number, px: number): number => Math.min(Math.max(slope, -1.2), 1.2) * px;
  const lens = `M${wide(left, 8)} -4L${wide(left, 14) - 2} -11H${wide(right, 14) + 2}L${wide(right, 8)} -4Z`;
  return (
    <g class="plan-camera" transform={`translate(${x} ${y}) rotate(${(sheet.turn * 180) / Math.PI})`}>
      <rect x="-8" y="3" width="16" height="15" rx="2" />
      <path class="plan-lens" d={lens} />
      <path class="plan-gate" d="M-6 6H6" />
      <circle r="1.8" />
    </g>
  );
}
