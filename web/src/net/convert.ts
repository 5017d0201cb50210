/** From JSON to the model: `null` distances are infinite, keys stay with their points. */

import type { CameraPlace } from "../model/camera_place";
import type { Curve } from "../model/curve";
import type { EditHistory } from "../model/history";
import type { LensSummary } from "../model/lens";
import type { Key, Keyed } from "../model/keys";
import type { FilmSummary, MeterReading, Photography } from "../model/photography";
import {
  KEYED_ATTRIBUTES,
  type Anchor,
  type CameraSummary,
  type FocusPoint,
  type FocusSettings,
  type LensSample,
  type Pick,
  type PointSharpness,
  type Readout,
  type Shot,
  type ShotSummary,
} from "../model/shot";
import type { CutPlace, TopView } from "../model/top_view";
import type { components } from "./schema";
import type { EditResult } from "./service";

export type Json = components["schemas"];

/** JSON has no infinity. */
export function distance(value: number | null): number {
  return value ?? Infinity;
}

export function toSummary(json: Json["ShotSummary"] | Json["Shot"]): ShotSummary {
  const { id, name, sizeBytes, fileCount, quarantine = null } = json;
  return { id, name, sizeBytes, fileCount, quarantine };
}

export function toShot(json: Json["Shot"], cameras: Json["CameraList"]): Shot {
  return {
    ...toSummary(json),
    range: json.frameRange,
    cameras: cameras.cameras.flatMap(toCamera),
    cameraPaths: json.cameras,
    defaultCamera: json.defaultCamera.path,
  };
}

function toCamera(json: Json["CameraState"]): CameraSummary[] {
  const aspect = json.horizontalApertureMm / json.verticalApertureMm;
  return json.path === null || !(aspect > 0) ? [] : [{ path: json.path, aspect }];
}

export function toReadout(json: Json["Readout"], points: readonly Json["PointSharpness"][] | null = null): Readout {
  const { focusMode, note, tiltDeg, swingDeg, lensName, lensModel, cocLimitMm } = json;
  const { closeFocusM, pupilToFilmMm } = json;
  const ring = { closeFocusM, pupilToFilmMm: [pupilToFilmMm[0] ?? 0, pupilToFilmMm[1] ?? 0] as const };
  const lens = { ...toLensSample(json), focusMode, note, tiltDeg, swingDeg, lensName, lensModel, cocLimitMm, ...ring };
  return { ...lens, pointSharpness: points && new Map(points.map((point) => [point.name, toSharpness(point)])) };
}

function toSharpness({ depthM, cocMm, focusDistanceM }: Json["PointSharpness"] | Json["FocusPoint"]): PointSharpness {
  const isAhead = depthM !== null && cocMm !== null;
  return { depthM, cocMm, focusDistanceM: isAhead ? distance(focusDistanceM) : null };
}

export function toFocusSettings(json: Json["FocusSettings"]): FocusSettings {
  return { ...json, keys: toKeyed(json.keys) };
}

export function toPhotography(
  exposure: Json["ExposureSettings"],
  film: Json["FilmSettings"],
  readout: Json["ExposureReadout"],
): Photography {
  return {
    exposure: { ...exposure, keys: toKeyed(exposure.keys) },
    film: { ...film, aspect: film.gateMm[0] / film.gateMm[1], keys: toKeyed(film.keys) },
    readout: {
      ...readout,
      effectiveTStop: distance(readout.effectiveTStop),
      greyNits: distance(readout.greyNits),
    },
  };
}

export function toReading(json: Json["MeterReading"]): MeterReading {
  const [x, y] = json.place ?? [];
  const place = x === undefined || y === undefined ? null : ([x, y] as const);
  return { ...json, place, ev100: json.ev100 ?? -Infinity, stops: json.stops ?? -Infinity };
}

export function toFilm(json: Json["FilmSummary"], base: string): FilmSummary {
  const { name, title, kind, process, speed, balanceK, description } = json;
  const sheet = `${base}/v1/films/${encodeURIComponent(name)}/sheet.png`;
  return { name, title, kind, process, speed, balanceK, description, sheet };
}

function toKeyed(keys: Readonly<Record<string, readonly Json["Key"][]>>): Keyed {
  return Object.fromEntries(Object.entries(keys).map(([name, ofName]) => [name, toKeys(ofName)]));
}

export function toLens(json: Json["LensSummary"], base: string): LensSummary {
  const { name, title, model, focalLengthMm, focalLengthRangeMm, fStop, description } = json;
  const { manufacturer, families, year } = json;
  const keywords = [manufacturer, ...families, year ?? ""].join(" ");
  const address = `${base}/v1/lenses/${encodeURIComponent(name)}`;
  const [section, sheet] = [`${address}/section.svg`, `${address}/sheet.png`];
  const numbers = { focalLengthMm, focalLengthRangeMm, fStop };
  return { name, title, model, ...numbers, description, keywords, section, sheet };
}

function toLensSample(json: Json["Readout"] | Json["CurveSample"]): LensSample {
  return {
    fStop: json.fStop,
    focalLengthMm: json.focalLengthMm,
    focusDistanceM: distance(json.focusDistanceM),
    nearM: json.nearM,
    farM: distance(json.farM),
    hyperfocalM: distance(json.hyperfocalM),
    source: json.source === "points" ? "points" : "camera",
    reason: json.reason,
  };
}

export function toCurve(json: Json["FocusCurve"]): Curve {
  return json.samples.map((sample) => ({
    ...toLensSample(sample),
    time: sample.timeCode,
    points: sample.points.map(({ name, depthM, share }) => ({ name, depthM, share })),
  }));
}

export function toPoint(json: Json["FocusPoint"]): FocusPoint {
  const { enabled, weight, kind, blurMm, falloff, offset, surfaceOffset, extent } = json;
  return {
    name: json.name,
    anchor: toAnchor(json),
    part: json.part,
    color: json.color,
    group: json.group,
    settings: { enabled, weight, kind, blurMm, falloff, offset, surfaceOffset, extent },
    keys: Object.fromEntries(KEYED_ATTRIBUTES.map((attribute) => [attribute, toKeys(json.keys[attribute])])),
    share: json.share,
    depthM: json.depthM,
    positionM: json.positionM,
    sharpness: toSharpness(json),
    screen: json.screen,
  };
}

export function toHistory(json: Json["EditHistory"]): EditHistory {
  const { revision, now, steps, undo, redo, cameras, notesTag } = json;
  return {
    revision,
    before: undo === null ? null : (steps[now - 1]?.revision ?? null),
    after: redo === null ? null : (steps[now + 1]?.revision ?? null),
    undo: undo ?? "",
    redo: redo ?? "",
    cameras,
    notesTag,
  };
}

export function toEditResult({ history, state, simplified, cameras }: Json["EditResult"]): EditResult {
  const { exposure, film, exposureReadout } = state ?? {};
  return {
    history: { ...history, undo: history.undo ?? "", redo: history.redo ?? "", cameras: null },
    cameras,
    points: state?.focusPoints?.focusPoints.map(toPoint) ?? null,
    readout: state?.readout ? toReadout(state.readout) : null,
    focusSettings: state?.focus ? toFocusSettings(state.focus) : null,
    photography: exposure && film && exposureReadout ? toPhotography(exposure, film, exposureReadout) : null,
    curve: state?.curve ? toCurve(state.curve) : null,
    simplified,
  };
}

export function toPick(json: Json["Pick"]): Pick | null {
  return json.hit && json.anchor && typeof json.depthM === "number"
    ? { anchor: toAnchor(json.anchor), depthM: json.depthM }
    : null;
}

export function toCameraPlace({ keys, edited, inShot }: Json["CameraPlace"]): CameraPlace {
  return {
    keys: keys.map((key) => ({ time: key.time, value: Number(key.edited), interpolation: "linear" })),
    isEdited: edited,
    isInShot: inShot,
  };
}

export function toTopView(json: Json["TopView"]): TopView {
  const { positionM, right, ahead, setBackM, gateMm, edges, axis, cut } = json;
  const [left = 0, rightmost = 0] = edges;
  return {
    ...{ positionM, right, ahead, setBackM, gateMm },
    edges: [left, rightmost],
    axis: toCutPlace(axis),
    cut: cut.map(toCutPlace),
  };
}

/** The limits of a pinhole are infinite. */
function toCutPlace({ slope, nearW, focusW, farW }: Json["CutPlace"]): CutPlace {
  return { slope, nearW: nearW ?? Infinity, focusW, farW: farW ?? -Infinity };
}

/** Without those that the shot says no finite value for. */
function toKeys(json: readonly Json["Key"][] = []): Key[] {
  return json.flatMap(({ time, value, interpolation = "linear", tangents }) =>
    value === null ? [] : [{ time, value, interpolation, ...(tangents ? { tangents } : {}) }],
  );
}

function toAnchor(json: Json["Anchor"] | Json["FocusPoint"]): Anchor {
  const { target, face = -1, fanTriangle = 0, barycentric = [1, 0, 0], instance = -1 } = json;
  return { target, face, fanTriangle, barycentric, instance };
}
