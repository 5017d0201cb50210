/** Names of the limits of sharpness and of the focus, with their distances, in the set from above. */

import type { JSX } from "preact";
import { formatDistance, type LengthUnit } from "../../model/distance";
import type { Readout } from "../../model/shot";
import { toSheet, type Place, type Sheet, type Spot, type TopView } from "../../model/top_view";
import { offsetText, type PlanPoint } from "./points";

interface LabelsProps {
  readonly sheet: Sheet;
  readonly view: TopView;
  readonly readout: Readout;
  readonly points: readonly PlanPoint[];
  readonly unit: LengthUnit;
}

/**
 * They stand at the right edge of the field of view, or on the right of names of points that are there. One that has no room is
 * left out: the foot of the plan has the distances.
 */
export function CutLabels({ sheet, view, readout, points, unit }: LabelsProps): JSX.Element {
  const depths = { far: readout.farM, focus: readout.focusDistanceM, near: readout.nearM };
  const labels = Object.entries(depths).flatMap(([name, depth]) => {
    const at: Place = [view.edges[1] * (depth + view.setBackM), depth];
    const [x, y] = Number.isFinite(depth) ? toSheet(sheet, at) : [NaN, NaN];
    const isInside = x > 0 && x < sheet.width - LABEL_PX && y > 8 && y < sheet.height - 8;
    return isInside ? [{ text: `${name} ${formatDistance(depth, unit)}`, name, at: [x + GAP_PX, y] as const }] : [];
  });
  const tags = points.map((point) => tagOf(sheet, point, unit));
  const spots = spread(
    labels.map(({ at }) => at),
    tags,
    sheet.width - LABEL_PX,
  );
  return (
    <>
      {labels.map(({ name, text }, index) => {
        const spot = spots[index];
        if (!spot) return null;
        const [x, y] = spot;
        return (
          <span key={name} class={`plan-label of-${name}`} aria-hidden="true" style={{ left: `${x}px`, top: `${y}px` }}>
            {text}
          </span>
        );
      })}
    </>
  );
}

/** Width that is kept for a label, its height, room beside it, and the width of a letter, px. */
const [LABEL_PX, LINE_PX, GAP_PX, LETTER_PX] = [70, 15, 6, 6.5];
/** From a point to its name, px. */
const TAG_PX = 10;

/** A name beside its point: its left and right ends, and the height of its middle, px. */
export interface Tag {
  readonly left: number;
  readonly right: number;
  readonly y: number;
}

function tagOf(sheet: Sheet, point: PlanPoint, unit: LengthUnit): Tag {
  const [x, y] = toSheet(sheet, point.place);
  const letters = [point.name, offsetText(point, unit)].filter(Boolean).join(" ").length;
  return { left: x, right: x + TAG_PX + letters * LETTER_PX + 2 * GAP_PX, y };
}

/** Places of labels, from the top one down, that cover neither each other nor a tag; null where there is no room up to a width. */
export function spread(labels: readonly Spot[], tags: readonly Tag[], width: number): (Spot | null)[] {
  const found: Spot[] = [];
  for (const [x, y] of labels) found.push([x, Math.max(y, (found.at(-1)?.[1] ?? -Infinity) + LINE_PX)]);
  const pushes = found.map(([x, y]) => ({ y, px: clearOf(x, y, tags) - x }));
  return found.map(([x, y]) => {
    // What is close together stays one column.
    const push = Math.max(...pushes.filter((each) => Math.abs(each.y - y) <= 2 * LINE_PX).map(({ px }) => px));
    return push === 0 || x + push <= width ? [x + push, y] : null;
  });
}

/** Where a label begins, from a place on, that covers no tag. */
function clearOf(x: number, y: number, tags: readonly Tag[]): number {
  let clear = x;
  for (const tag of [...tags].sort((a, b) => a.left - b.left)) {
    const isBeside = Math.abs(tag.y - y) > LINE_PX || tag.right <= clear || tag.left >= clear + LABEL_PX;
    if (!isBeside) clear = tag.right + GAP_PX;
  }
  return clear;
}
