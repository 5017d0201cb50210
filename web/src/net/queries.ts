/** Parts of requests that many of them have. */

import type { MeterRequest } from "../model/photography";
import type { Quality } from "../model/quality";
import type { paths } from "./schema";
import { cameraOf, type View } from "./view";

/** The condition that the edits of a shot are still at a revision. */
export function ifStill(
  shot: string,
  revision: string,
): { params: { path: { shot: string }; header: { "if-match": string } } } {
  return { params: { path: { shot }, header: { "if-match": `"${revision}"` } } };
}

export type PictureQuery = paths["/v1/shots/{shot}/frame"]["get"]["parameters"]["query"];

export function pictureOf(
  time: number,
  { width, height, rays, layers, supersample, motion, motionBy }: Quality,
): PictureQuery {
  return { time, width, height, rays, layers, supersample, motion, motionBy };
}

export function meterOf(
  time: number,
  request: MeterRequest | null,
): { time: number; mode?: MeterRequest["mode"]; point?: string } {
  return { time, ...(request && { mode: request.mode, ...(request.point !== null && { point: request.point }) }) };
}

export function at<Query extends object>(
  view: View,
  query: Query,
): { params: { path: { shot: string }; query: Query & { camera?: string } } } {
  return { params: { path: { shot: view.shot }, query: { ...query, ...cameraOf(view) } } };
}

export function abortable(signal: AbortSignal | undefined): { signal?: AbortSignal } {
  return signal ? { signal } : {};
}
