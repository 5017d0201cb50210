/** The service as the page uses it, in the model's terms. `net/http.ts` implements it over REST; tests have a fake. */

import type { CameraPlace } from "../model/camera_place";
import type { Changes } from "../model/changes";
import type { Choices } from "../model/choices";
import type { Curve } from "../model/curve";
import type { NoteList } from "../model/frame_notes";
import type { EditHistory } from "../model/history";
import type { Who } from "../model/identity";
import type { LensSummary } from "../model/lens";
import type { GradeChoices, Libraries, MeterRequest, MeterReading, Photography } from "../model/photography";
import type { CacheEngine, PictureSize, Quality } from "../model/quality";
import type { FocusPoint, FocusSettings, Note, Pick, Readout, Shot, ShotSummary, TrashedShot } from "../model/shot";
import type { Paths, TopView } from "../model/top_view";
import type { LiveListener, LiveLink } from "./live_link";
import type { components } from "./schema";
import type { PatienceListener } from "./patience";
import type { RenderService } from "./renders";
import type { EditsListener, EventLink } from "./shot_events";
import type { View } from "./view";

/** An edit to be made. */
export interface Edit {
  /** Its name in the history. */
  readonly label: string;
  /** Names one gesture: its edits, one after the other, are one step of undo. */
  readonly gesture?: string | undefined;
  readonly changes: Changes;
  /** Time code of the state in the answer. */
  readonly time: number;
  /** Whether the answer has the focus curve. */
  readonly withCurve: boolean;
}

/** The shot after an edit, at the edit's time; a part that the service could not read is null. */
export interface EditResult {
  readonly history: EditHistory;
  /** Prim paths of the cameras that it created. */
  readonly cameras: readonly string[];
  readonly points: readonly FocusPoint[] | null;
  readonly readout: Readout | null;
  readonly focusSettings: FocusSettings | null;
  readonly photography: Photography | null;
  readonly curve: Curve | null;
  readonly simplified: readonly Simplified[];
}

/** Keys of a setting that were made few. */
export type Simplified = components["schemas"]["SimplifiedSetting"];

export interface Download {
  readonly blob: Blob;
  readonly name: string;
}

export type CurveFormat = "json" | "csv" | "usda" | "otio" | "opentrackio";
export type PictureFormat = "png" | "jpeg" | "exr";

/** A picture, and the revision of the edits that it is of. */
export interface PictureOfEdits {
  readonly blob: Blob;
  readonly revision: string;
}

/** A focus map, encoded, and the revision of the edits that it is of. */
export interface MapOfEdits {
  readonly data: ArrayBuffer;
  readonly revision: string;
}

/** What pictures depend on at a revision of the edits, by time; null where none can be made. */
export interface PictureStates {
  readonly revision: string;
  readonly by: ReadonlyMap<number, string | null>;
}

/** A file to send. */
export interface Sending {
  readonly file: File;
  /** Root layer within a zip; null where the service chooses. */
  readonly root: string | null;
}

/** The set from above, and the place of the camera. */
export interface FromAbove {
  cameraPlace(view: View, time: number, signal?: AbortSignal): Promise<CameraPlace>;
  /** The camera. */
  topView(view: View, time: number, signal?: AbortSignal): Promise<TopView>;
  /** The ways of a camera and its focus points over the shot. */
  paths(view: View, signal?: AbortSignal): Promise<Paths>;
}

export interface Service {
  /** Jobs of many frames. */
  readonly renders: RenderService;
  /** The set from above. */
  readonly fromAbove: FromAbove;
  /** Sets who is asked for a key, and told of waits; until then requests that are refused fail. */
  listen(listener: PatienceListener): void;
  /** Who sends the requests. */
  whoAmI(): Promise<Who>;
  /** Exchanges a key for a session, which signs all that the page sends. Fails with status 401 where the key is wrong. */
  signIn(key: string): Promise<Who>;
  signOut(): Promise<void>;
  shots(): Promise<ShotSummary[]>;
  /** Sends a shot. Fails with `ambiguous_root`, and the candidates as subjects, where a zip has several that could be its root. */
  upload(sending: Sending, onProgress: (fraction: number) => void, signal: AbortSignal): Promise<ShotSummary>;
  /** Moves a shot with its edits to the trash. */
  removeShot(shot: string): Promise<void>;
  /** The deleted shots, the last one first. */
  trash(): Promise<readonly TrashedShot[]>;
  /** Restores a shot by the id of its entry in the trash. */
  restore(entry: string): Promise<ShotSummary>;
  /** Releases a shot from quarantine. */
  release(shot: string): Promise<void>;
  open(shot: string, signal?: AbortSignal): Promise<Shot>;
  /** The lens library. */
  lenses(): Promise<readonly LensSummary[]>;
  /** The libraries of films and bodies. */
  libraries(): Promise<Libraries>;
  /** What the shot leaves open. */
  choices(shot: string, signal?: AbortSignal): Promise<Choices>;
  /** The notes at its frames. */
  frameNotes(view: View, signal?: AbortSignal): Promise<NoteList>;
  /** The history of the shot's edits. */
  history(shot: string): Promise<EditHistory>;
  /** Undoes the last edit if it led to `revision`, else fails. */
  undo(shot: string, revision: string): Promise<EditHistory>;
  redo(shot: string, revision: string): Promise<EditHistory>;
  /** Features of the shot that are not honoured. */
  notes(shot: string): Promise<readonly Note[]>;
  /** Opens live pictures of a view. */
  live(view: View, listener: LiveListener): LiveLink;
  /** Tells of the edits of a shot, whoever makes them, until it is closed. */
  edits(shot: string, listener: EditsListener): EventLink;
  /** A graded picture. */
  frame(view: View, time: number, quality: Quality, signal?: AbortSignal): Promise<Blob>;
  /** A graded picture for playing, by an engine. */
  cacheFrame(
    view: View,
    time: number,
    quality: Quality,
    engine: CacheEngine,
    signal?: AbortSignal,
  ): Promise<PictureOfEdits>;
  /** The focus map of a picture. */
  focusMap(view: View, time: number, quality: Quality, signal?: AbortSignal): Promise<MapOfEdits>;
  /** The exposure map of a picture, encoded. */
  exposureMap(view: View, time: number, size: PictureSize, signal?: AbortSignal): Promise<ArrayBuffer>;
  /** What the pictures of the frames from one time to another depend on. */
  pictureStates(view: View, start: number, end: number, signal?: AbortSignal): Promise<PictureStates>;
  focusPoints(view: View, time: number, signal?: AbortSignal): Promise<FocusPoint[]>;
  focusSettings(view: View, time: number, signal?: AbortSignal): Promise<FocusSettings>;
  readout(view: View, time: number, signal?: AbortSignal): Promise<Readout>;
  /** Exposure, shutter, film and grade of a camera. */
  photography(view: View, time: number, signal?: AbortSignal): Promise<Photography>;
  /** Reads a light meter; a null request reads the camera's own. */
  meter(view: View, time: number, request: MeterRequest | null, signal?: AbortSignal): Promise<MeterReading>;
  /** Displays, views and looks to grade by. */
  grades(view: View, time: number): Promise<GradeChoices>;
  curve(view: View, signal?: AbortSignal): Promise<Curve>;
  /** Picks the surface at a place of the picture (0 to 1 from its top left); null for none. */
  pick(
    view: View,
    time: number,
    at: readonly [number, number],
    quality: Quality,
    signal?: AbortSignal,
  ): Promise<Pick | null>;
  /** Makes an edit, all of it or nothing. Fails where another editor has changed the same resource since it was read. */
  edit(view: View, edit: Edit): Promise<EditResult>;
  /** Drops the tags of a shot's resources that are read again from now on. */
  forget(shot: string): void;
  downloadFrame(
    view: View,
    time: number,
    quality: Quality,
    format: PictureFormat,
    signal?: AbortSignal,
  ): Promise<Download>;
  downloadCurve(view: View, format: CurveFormat, signal?: AbortSignal): Promise<Download>;
  downloadEdits(shot: string, signal?: AbortSignal): Promise<Download>;
}
