/** What the page asks of the service, in the model's own terms. `net/http.ts` asks it over REST; tests answer themselves. */

import type { Changes } from "../model/changes";
import type { Curve } from "../model/curve";
import type { EditHistory } from "../model/history";
import type { LensSummary } from "../model/lens";
import type { GradeChoices, Libraries, MeterAsked, MeterReading, Photography } from "../model/photography";
import type { Quality } from "../model/quality";
import type { FocusPoint, FocusSettings, Note, Pick, Readout, Shot, ShotSummary } from "../model/shot";
import type { LiveEar, LiveLink } from "./live_link";
import type { View } from "./view";

/** An edit that is asked for. */
export interface Edit {
  /** Its name in the history. */
  readonly label: string;
  readonly changes: Changes;
  /** At which the person looks. */
  readonly time: number;
  /** Whether the answer has the focus curve. */
  readonly withCurve: boolean;
}

/** The shot after an edit, at the edit's time; a part that the service could not read is null. */
export interface Edited {
  readonly history: EditHistory;
  readonly points: readonly FocusPoint[] | null;
  readonly readout: Readout | null;
  readonly focusSettings: FocusSettings | null;
  readonly photography: Photography | null;
  readonly curve: Curve | null;
}

export interface Download {
  readonly blob: Blob;
  readonly name: string;
}

export type CurveFormat = "json" | "csv" | "usda" | "otio" | "opentrackio";
export type PictureFormat = "png" | "jpeg" | "exr";

export interface Service {
  shots(): Promise<ShotSummary[]>;
  upload(file: File, onProgress: (fraction: number) => void, signal: AbortSignal): Promise<ShotSummary>;
  removeShot(shot: string): Promise<void>;
  open(shot: string): Promise<Shot>;
  /** The lens library. */
  lenses(): Promise<readonly LensSummary[]>;
  /** The libraries of films and bodies. */
  libraries(): Promise<Libraries>;
  /** What of the shot's edits can be undone. */
  history(shot: string): Promise<EditHistory>;
  /** Takes back the last edit if it is the one that came to `revision`, else fails. */
  undo(shot: string, revision: string): Promise<EditHistory>;
  redo(shot: string, revision: string): Promise<EditHistory>;
  /** What of the shot is not shown as it says. */
  notes(shot: string): Promise<readonly Note[]>;
  /** Pictures of a view as they are wanted, that get better and better. */
  live(view: View, ear: LiveEar): LiveLink;
  /** A graded picture. */
  frame(view: View, time: number, quality: Quality, signal?: AbortSignal): Promise<Blob>;
  focusPoints(view: View, time: number, signal?: AbortSignal): Promise<FocusPoint[]>;
  focusSettings(view: View, time: number, signal?: AbortSignal): Promise<FocusSettings>;
  readout(view: View, time: number, signal?: AbortSignal): Promise<Readout>;
  /** Exposure, shutter, film and grade of a camera. */
  photography(view: View, time: number, signal?: AbortSignal): Promise<Photography>;
  /** What a light meter says; null looks at what the camera's own does. */
  meter(view: View, time: number, asked: MeterAsked | null, signal?: AbortSignal): Promise<MeterReading>;
  /** What the camera's picture can be graded by. */
  grades(view: View, time: number): Promise<GradeChoices>;
  curve(view: View, signal?: AbortSignal): Promise<Curve>;
  /** What is seen at a place of the picture (0 to 1 from its top left), or null for nothing. */
  pick(view: View, time: number, at: readonly [number, number], quality: Quality): Promise<Pick | null>;
  /** Applies an edit, all of it or nothing. Fails where somebody else changed the same thing since it was read last. */
  edit(view: View, edit: Edit): Promise<Edited>;
  /** Takes what is read of a shot from now on for what the person sees and edits. */
  forget(shot: string): void;
  downloadFrame(view: View, time: number, quality: Quality, format: PictureFormat): Promise<Download>;
  downloadCurve(view: View, format: CurveFormat): Promise<Download>;
  downloadEdits(shot: string): Promise<Download>;
}
