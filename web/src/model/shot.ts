/** Data of a shot. Lengths in metres, lens and film lengths in millimetres, times in USD time codes. */

import type { components } from "../net/schema";
import type { Key, Keyed } from "./keys";
import { FOCUS_CHOICES, type FOCUS_SLIDERS } from "./settings.gen";
import type { FrameRange } from "./time";
import type { Vector } from "./vector";

type Json = components["schemas"];

export interface ShotSummary {
  readonly id: string;
  readonly name: string;
  readonly sizeBytes: number;
  readonly fileCount: number;
  /** Reason why it is not opened until somebody releases it; null where it is opened. */
  readonly quarantine: string | null;
}

/** A deleted shot that can be restored. */
export interface TrashedShot {
  /** Of the entry of the trash. */
  readonly id: string;
  /** Id that the shot had, and will have again. */
  readonly shot: string;
  readonly name: string;
  /** When it is removed for good. */
  readonly removedAt: string;
}

export interface CameraSummary {
  /** Prim path. */
  readonly path: string;
  /** Width over height of the film gate. */
  readonly aspect: number;
}

/** Something that the shot uses and the renderer does not honour. */
export interface Note {
  readonly code: string;
  readonly path: string;
  readonly message: string;
}

/** Data that does not change while a shot is open. */
export interface Shot extends ShotSummary {
  readonly range: FrameRange;
  readonly cameras: readonly CameraSummary[];
  /** Prim paths of all cameras, those whose numbers make no picture included. */
  readonly cameraPaths: readonly string[];
  /** The default camera; null where the shot has none and a camera is made that frames it. */
  readonly defaultCamera: string | null;
}

/** Settings of the lens at one time. */
export interface Lens {
  /** 0 is a pinhole. */
  readonly fStop: number;
  readonly focalLengthMm: number;
  /** Along the view axis; may be infinite. */
  readonly focusDistanceM: number;
}

/**
 * Who focuses: the focus puller's hand, or the focus points; these by one distance, by a plane that the tilted lens lays
 * through them, or by a surface through all of them, which no lens has.
 */
export const FOCUS_MODES = ["manual", "points", "tiltPlane", "surface"] as const;
export type FocusMode = (typeof FOCUS_MODES)[number];
/** How the focus is found, after "Focus". */
export const FOCUS_MODE_WORDS: Readonly<Record<FocusMode, string>> = {
  manual: "by hand",
  points: "by points",
  tiltPlane: "by a tilted plane",
  surface: "by a surface",
};

/** Focus settings, apart from the points. All but the mode take keys. */
export type FocusSettings = Omit<Json["FocusSettings"], "camera" | "time" | "etag" | "keys"> & {
  /** Keys of these settings and of the lens. */
  readonly keys: Keyed;
};

export const OFF_SCREEN = FOCUS_CHOICES.offScreen;
export type OffScreen = FocusSettings["offScreen"];
/** In the order in which the page lists them. */
export const OCCLUDED = ["keep", "fade", "ignore"] as const satisfies readonly FocusSettings["occluded"][];
export type Occluded = FocusSettings["occluded"];
export type FocusSwitch = "solveStop" | "drivenByPoints";
export type FocusNumber = keyof typeof FOCUS_SLIDERS;

/** The lens at one time, and what it makes sharp; distances may be infinite. */
export interface LensSample extends Lens {
  readonly nearM: number;
  readonly farM: number;
  readonly hyperfocalM: number;
  /** Whether focus points decided, or the camera's own focus distance was kept. */
  readonly source: "points" | "camera";
  /** One sentence that says why. */
  readonly reason: string;
}

export interface Readout extends LensSample {
  /** For the whole shot. */
  readonly focusMode: FocusMode;
  /** Sentence about a setting that the lens cannot follow; or empty. */
  readonly note: string;
  /** Turn of the lens, positive looks up. */
  readonly tiltDeg: number;
  /** Turn of the lens before the tilt, positive looks left. */
  readonly swingDeg: number;
  /** Engraving of the lens; may be empty. */
  readonly lensName: string;
  /** Model of how light passes the lens. */
  readonly lensModel: string;
  /** Largest diameter on the film of a circle of confusion that is sharp. */
  readonly cocLimitMm: number;
  /** Depth of the nearest focus on the ring of the lens, from the entrance pupil. */
  readonly closeFocusM: number;
  /** From the entrance pupil to the film, focused at infinity and at the close focus. */
  readonly pupilToFilmMm: readonly [number, number];
  /** Sharpness of the focus points, by name, where it came with the readout: that of a lens that is being dragged. */
  readonly pointSharpness: ReadonlyMap<string, PointSharpness> | null;
}

/** The attributes of a focus point that take keys. `enabled` is 0 or 1. */
export const KEYED_ATTRIBUTES = ["weight", "enabled", "blur", "falloff", "surfaceOffset", "extent"] as const;
export type KeyedAttribute = (typeof KEYED_ATTRIBUTES)[number];

/** Where on the geometry a focus point sits; it goes with that triangle. */
export interface Anchor {
  /** Prim paths: a mesh, or a point instancer and the prototype's mesh. */
  readonly target: readonly string[];
  readonly face: number;
  /** Which triangle of the face's fan. */
  readonly fanTriangle: number;
  readonly barycentric: readonly [number, number, number];
  /** Instance of the point instancer, or -1. */
  readonly instance: number;
}

/** Values of a focus point, apart from its keys. */
export interface PointSettings {
  readonly enabled: boolean;
  readonly weight: number;
  readonly kind: "sharp" | "soft";
  /** Diameter of a soft point's circle of confusion on the film. */
  readonly blurMm: number;
  /** Distance in frame widths where its influence ends; 0 is nowhere. */
  readonly falloff: number;
  /** From the anchor, in scene units and the target's own space. */
  readonly offset: readonly [number, number, number];
  /** Distance of the focus behind a soft point without blur, in scene units. */
  readonly surfaceOffset: number;
  /** Depth of field around it in surface mode, relative to the lens's. */
  readonly extent: number;
}

/** How sharp a point is; numbers are null where it is not in front of the camera. */
export interface PointSharpness {
  readonly depthM: number | null;
  /** Diameter of its circle of confusion on the film. */
  readonly cocMm: number | null;
  /** Depth of the focal surface where it stands in the picture; may be infinite. */
  readonly focusDistanceM: number | null;
}

/** Colours that tell points apart, as USD names them. */
export const POINT_COLORS = ["none", "red", "orange", "yellow", "green", "teal", "blue", "purple", "pink"] as const;
export type PointColor = (typeof POINT_COLORS)[number];

/** A focus point at one time. */
export interface FocusPoint {
  readonly name: string;
  readonly anchor: Anchor;
  /** Path of a prim whose bounds it follows in place of its anchor, or empty. */
  readonly part: string;
  readonly color: PointColor;
  /** Name of the group that lists show it in, or empty. */
  readonly group: string;
  readonly settings: PointSettings;
  /** By attribute; those that are not keyed are not there. */
  readonly keys: Readonly<Partial<Record<KeyedAttribute, readonly Key[]>>>;
  /** Share of the weight that decides the focus, 0 to 1. */
  readonly share: number;
  /** Along the view axis, negative behind the camera; null where the point has no place at this time. */
  readonly depthM: number | null;
  /** In the world: metres, +Y up; null where the point has no place at this time. */
  readonly positionM: Vector | null;
  readonly sharpness: PointSharpness;
  /** In the picture, 0 to 1 from its top left corner; null where it is not in front of the camera. */
  readonly screen: readonly [number, number] | null;
}

/** Ease of a rack: even, or soft at its start, its end or both. */
export const EASES = ["smooth", "in", "out", "linear"] as const;
export type Ease = (typeof EASES)[number];

export interface Rack {
  /** Names of points. */
  readonly from: string;
  readonly to: string;
  readonly start: number;
  /** The lens may need longer. */
  readonly end: number;
  readonly ease: Ease;
}

/** The surface under a click. */
export interface Pick {
  readonly anchor: Anchor;
  readonly depthM: number;
}

/** The keys of an attribute, in the order of time. */
export function keysOf(point: FocusPoint, attribute: KeyedAttribute): readonly Key[] {
  return point.keys[attribute] ?? [];
}

/** Whether a point is in the picture. */
export function inFrame(point: FocusPoint): boolean {
  return point.screen?.every((at) => at >= 0 && at <= 1) ?? false;
}

/** The last part of a prim path. */
export function primName(path: string): string {
  return path.slice(path.lastIndexOf("/") + 1) || path;
}

/**
 * A name for the thing at a prim path: its own with that of its parent.
 *
 * Meshes are often named after their material or just `mesh`; the scope right under the root says nothing either way.
 */
export function thingName(path: string): string {
  return path.split("/").slice(2).slice(-2).join("_") || primName(path);
}
