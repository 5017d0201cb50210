/** The drawing of the set from above: what of the plan it shows, and how that is moved by pointer, wheel and keys. */

import type { RefObject } from "preact";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import type { PlanUp } from "../../editor/remembered";
import type { Session } from "../../editor/session";
import {
  endsOf,
  fitted,
  headingOf,
  panned,
  toPlan,
  zoomed,
  type Place,
  type Sheet,
  type Spot,
  type TopView,
} from "../../model/top_view";
import { followPointer } from "../hooks";

/** Room around all that is shown, for the names of points, px. */
const MARGIN_PX = 44;
/** By which a button or a key zooms. */
export const ZOOM_STEP = 1.25;
const [PAN_PX, WHEEL_ZOOM] = [40, 0.0015];

interface Size {
  readonly width: number;
  readonly height: number;
}

/** The drawing as it was left, else so that it shows all; null where it has no size yet. */
export function useSheet(session: Session, view: TopView | null, { width, height }: Size, up: PlanUp): Sheet | null {
  const { topView } = session;
  const [left, ways] = [topView.sheet.value, topView.paths.value !== null];
  const turn = view && up === "north" ? headingOf(view) : 0;
  const isThere = view !== null && width > 0 && height > 0;
  const empty = { width, height, turn, pxPerM: 1, middle: [0, 0] as const };
  const fit = (): Sheet => (view ? fitted(empty, contentOf(session, view), MARGIN_PX) : empty);
  // It shows all where one of these changes, and stays as it is while something moves in it.
  const shape = `${width} ${height} ${up} ${String(ways)}`;
  const fittedAs = useRef("");
  useLayoutEffect(() => {
    const isOld = left === null || (left.isFitted && fittedAs.current !== shape);
    if (!isThere || !isOld) return;
    fittedAs.current = shape;
    leave(session, fit(), true);
  });
  if (!isThere) return null;
  return left ? { ...empty, pxPerM: left.pxPerM, middle: left.middle } : fit();
}

/** Where all is, but for limits of sharpness that are so far away that the rest would be small beside them. */
function contentOf({ document, topView }: Session, view: TopView): Place[] {
  const [readout, paths] = [document.readout.value, topView.paths.value];
  const points = document.points.value.map(({ positionM }) => positionM);
  const ways = paths?.points.flatMap(({ positionsM }) => positionsM) ?? [];
  const placed = [...points, ...ways].flatMap((at) => (at ? [toPlan(view, at)] : []));
  const deepest = Math.max(endsOf(placed, 1)[1], 1);
  const lens = readout ? [readout.nearM, readout.focusDistanceM, readout.farM] : [];
  return [[0, 0], ...placed, ...lens.filter((depth) => depth < 2 * deepest).map((depth): Place => [0, depth])];
}

/** Keeps a drawing as it is now. */
function leave(session: Session, { pxPerM, middle }: Sheet, isFitted = false): void {
  session.topView.sheet.value = { pxPerM, middle, isFitted };
}

/** Lets the wheel zoom at the pointer. */
export function useWheel(session: Session, place: RefObject<HTMLElement | null>, sheet: Sheet | null): void {
  useEffect(() => {
    const element = place.current;
    if (!element || !sheet) return undefined;
    const turned = (event: WheelEvent): void => {
      event.preventDefault();
      leave(session, zoomed(sheet, Math.exp(-event.deltaY * WHEEL_ZOOM), spotOf(element, event)));
    };
    // Else the browser would scroll the page, too.
    element.addEventListener("wheel", turned, { passive: false });
    return () => {
      element.removeEventListener("wheel", turned);
    };
  }, [session, place, sheet]);
}

/** Where in an element a pointer is, px. */
export function spotOf(element: Element, { clientX, clientY }: Pick<PointerEvent, "clientX" | "clientY">): Spot {
  const { left, top } = element.getBoundingClientRect();
  return [clientX - left, clientY - top];
}

/** Moves the drawing with a pointer. */
export function pan(session: Session, sheet: Sheet, down: PointerEvent): void {
  if (down.button !== 0) return;
  followPointer(
    down,
    ({ clientX, clientY }) => {
      leave(session, panned(sheet, clientX - down.clientX, clientY - down.clientY));
    },
    () => undefined,
  );
}

const ARROWS: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

/** The way of an arrow key: to the right and down; null for any other key. */
export function arrowOf(key: string): readonly [number, number] | null {
  return ARROWS[key] ?? null;
}

/** Moves, zooms or fits the drawing by a key; returns whether it is one for that. */
export function moveByKey(session: Session, sheet: Sheet, { key, shiftKey }: KeyboardEvent): boolean {
  const arrow = arrowOf(key);
  if (arrow) {
    const px = shiftKey ? 5 * PAN_PX : PAN_PX;
    leave(session, panned(sheet, -arrow[0] * px, -arrow[1] * px));
  } else if (key.toLowerCase() === "f") session.topView.sheet.value = null;
  else return zoomByKey(session, sheet, key);
  return true;
}

/** Zooms at the middle by a key; returns whether it is one for that. */
export function zoomByKey(session: Session, sheet: Sheet, key: string): boolean {
  if (key !== "+" && key !== "=" && key !== "-") return false;
  zoomBy(session, sheet, key === "-" ? 1 / ZOOM_STEP : ZOOM_STEP);
  return true;
}

export function zoomBy(session: Session, sheet: Sheet, factor: number): void {
  leave(session, zoomed(sheet, factor, [sheet.width / 2, sheet.height / 2]));
}
