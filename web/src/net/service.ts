/** What the page asks of the service, in the model's own terms. `net/http.ts` asks it over REST; tests answer themselves. */

import type { Command } from "../model/command";
import type { Curve } from "../model/curve";
import type { LensSummary } from "../model/lens";
import type { Quality } from "../model/quality";
import type { FocusPoint, Note, Pick, Readout, Shot, ShotSummary } from "../model/shot";

/** Which camera of which shot; null is the shot's own choice. */
export interface View {
  readonly shot: string;
  readonly camera: string | null;
}

export interface Download {
  readonly blob: Blob;
  readonly name: string;
}

export type CurveFormat = "json" | "csv" | "usda";
export type PictureFormat = "png" | "jpeg" | "exr";

export interface Service {
  shots(): Promise<ShotSummary[]>;
  upload(file: File, onProgress: (fraction: number) => void, signal: AbortSignal): Promise<ShotSummary>;
  removeShot(shot: string): Promise<void>;
  open(shot: string): Promise<Shot>;
  /** The lens library. */
  lenses(): Promise<readonly LensSummary[]>;
  /** A word for the state of the shot's edits, to go back to. */
  revision(shot: string): Promise<string>;
  /** What of the shot is not shown as it says. */
  notes(shot: string): Promise<readonly Note[]>;
  /** A graded picture. */
  frame(view: View, time: number, quality: Quality, signal?: AbortSignal): Promise<Blob>;
  focusPoints(view: View, time: number, signal?: AbortSignal): Promise<FocusPoint[]>;
  readout(view: View, time: number, signal?: AbortSignal): Promise<Readout>;
  curve(view: View, signal?: AbortSignal): Promise<Curve>;
  /** What is seen at a place of the picture (0 to 1 from its top left), or null for nothing. */
  pick(view: View, time: number, at: readonly [number, number], quality: Quality): Promise<Pick | null>;
  /** @param time at which the person looks: what is keyed is changed there. */
  perform(view: View, command: Command, time: number): Promise<void>;
  downloadFrame(view: View, time: number, quality: Quality, format: PictureFormat): Promise<Download>;
  downloadCurve(view: View, format: CurveFormat): Promise<Download>;
  downloadEdits(shot: string): Promise<Download>;
}
