/** What the page asks of the service, in the model's own terms. `net/http.ts` asks it over REST; tests answer themselves. */

import type { Command } from "../model/command";
import type { Curve } from "../model/curve";
import type { EditHistory } from "../model/history";
import type { LensSummary } from "../model/lens";
import type { GradeChoices, Libraries, MeterAsked, MeterReading, Photography } from "../model/photography";
import type { Quality } from "../model/quality";
import type { LiveEar, LiveLink } from "./live";
import type { FocusPoint, FocusSettings, Note, Pick, Readout, Shot, ShotSummary } from "../model/shot";

/** Which camera of which shot; null is the shot's own choice. */
export interface View {
  readonly shot: string;
  readonly camera: string | null;
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
  /** Goes back to an earlier state of the edits, `to`, if `now` is still the present one. */
  restore(shot: string, to: string, now: string, gesture: string): Promise<void>;
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
  /**
   * Does one thing to a shot. Fails where somebody else changed the same thing since it was read last.
   *
   * @param time at which the person looks: what is keyed is changed there.
   * @param gesture names the edit that it is part of: what is done in one, one after the other, is one step of undo.
   */
  perform(view: View, command: Command, time: number, gesture: string): Promise<void>;
  /** Takes what is read of a shot from now on for what the person sees and edits. */
  forget(shot: string): void;
  downloadFrame(view: View, time: number, quality: Quality, format: PictureFormat): Promise<Download>;
  downloadCurve(view: View, format: CurveFormat): Promise<Download>;
  downloadEdits(shot: string): Promise<Download>;
}
