/** The focus points as the set from above shows them: where they are, and how far off the focus. */

import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import type { LengthUnit } from "../../model/distance";
import { formatOffset, judge } from "../../model/sharpness";
import type { FocusPoint } from "../../model/shot";
import { toPlan, type Place, type TopView } from "../../model/top_view";
import type { Vector } from "../../model/vector";
import { limitOf } from "../sharp_limit";

/** A focus point that has a place. */
export type PlacedPoint = FocusPoint & { readonly positionM: Vector };

export interface PlanPoint {
  readonly name: string;
  readonly point: PlacedPoint;
  readonly place: Place;
  /** Depth of the focus on its ray; may be infinite, and null where the point is behind the camera. */
  readonly focusDistanceM: number | null;
  readonly isSharp: boolean;
  /** How far it is behind the focus; null where that is not known. */
  readonly offsetM: number | null;
}

/** Where points are shown that are moved, by their identities. */
export type Moved = ReadonlyMap<number, Place>;

/** Those points, with one shown at a place, or where it is saved. */
export function withMoved(moved: Moved, identity: number, place: Place | null): Moved {
  const others = [...moved].filter(([other]) => other !== identity);
  return new Map(place ? [...others, [identity, place]] : others);
}

export function planPoints(editor: Editor, session: Session, view: TopView, moved: Moved): PlanPoint[] {
  const limitMm = limitOf(editor, session);
  return session.document.points.value.filter(isPlaced).map((point) => {
    const sharpness = session.sharpnessOf(point);
    const verdict = limitMm === null ? null : judge(sharpness, limitMm);
    return {
      name: point.name,
      point,
      place: moved.get(session.pointEdits.identityOf(point.name)) ?? toPlan(view, point.positionM),
      focusDistanceM: sharpness.focusDistanceM,
      isSharp: verdict?.isSharp ?? false,
      offsetM: verdict?.offsetM ?? null,
    };
  });
}

function isPlaced(point: FocusPoint): point is PlacedPoint {
  return point.positionM !== null;
}

export function inFrontOf({ setBackM }: TopView, [, depth]: Place): boolean {
  return depth + setBackM > 0;
}

/** How far a soft point is behind the focus, in words; null for a sharp one and where that is not known. */
export function offsetText({ offsetM, isSharp }: PlanPoint, unit: LengthUnit): string | null {
  return offsetM === null || isSharp ? null : formatOffset(offsetM, unit);
}
