/** Commands as requests, and what each of them is made upon. */

import type { Client } from "openapi-fetch";
import type { Command, Trial } from "../model/command";
import type { Json } from "./convert";
import type { paths } from "./schema";
import type { View } from "./service";

/** What openapi-fetch resolves to: one of the two is there. */
export interface Answer<Data> {
  readonly data?: Data;
  readonly error?: unknown;
  readonly response: Response;
}

/** What a command goes out with. */
export interface Terms {
  /** At which the person looks: what is keyed is changed there. */
  readonly time: number;
  /** Names the edit that it is part of. */
  readonly gesture: string;
  /** Entity tag of what it is made upon; null where none is known. */
  readonly tag: string | null;
}

/** What has an entity tag: the camera, the list of focus points, and each of these. */
export const [CAMERA, POINTS] = ["camera", "points"];

export function pointThing(name: string): string {
  return `point ${name}`;
}

/** What must not have changed since it was read. */
export function thingOf(command: Command): string {
  if (command.do === "addPoint" || command.do === "rack") return POINTS;
  return "name" in command ? pointThing(command.name) : CAMERA;
}

/** The camera as a parameter: left out, the service takes the shot's own. */
export function cameraOf(view: View): { camera?: string } {
  return view.camera === null ? {} : { camera: view.camera };
}

const CAMERA_ADDRESS = "/v1/shots/{shot}/camera";
const POINTS_ADDRESS = "/v1/shots/{shot}/focus-points";

export function send(client: Client<paths>, view: View, command: Command, terms: Terms): Promise<Answer<unknown>> {
  if ("name" in command) return sendOfPoint(client, view, command, terms);
  const query = { ...cameraOf(view), gesture: terms.gesture };
  const params = { path: { shot: view.shot }, query, header: headerOf(terms) };
  switch (command.do) {
    case "setLens":
      return client.PATCH(CAMERA_ADDRESS, { params, body: lensIn(command) });
    case "setFocus":
      return client.PATCH("/v1/shots/{shot}/camera/focus", { params, body: changeIn(command) });
    case "rack":
      return client.POST("/v1/shots/{shot}/racks", { params, body: command.rack });
    case "mountLens":
      return client.PATCH(CAMERA_ADDRESS, { params, body: { lens: command.lens } });
    case "mountLensFile": {
      const body = new FormData();
      body.append("file", command.file);
      // The document has the file as text; what travels is the form.
      return client.PUT("/v1/shots/{shot}/camera/lens", { params, body: body as unknown as { file: string } });
    }
    case "mountBody":
      return client.PATCH(CAMERA_ADDRESS, { params, body: { body: command.body } });
    case "setExposure":
      return client.PATCH(`${CAMERA_ADDRESS}/exposure`, { params, body: changeIn(command) });
    case "setFilm":
      return client.PATCH(`${CAMERA_ADDRESS}/film`, { params, body: changeIn(command) });
    case "importCurve": {
      const body = new FormData();
      body.append("file", command.file);
      const filled = { ...params, query: { ...query, gaps: "interpolate" as const } };
      return client.PUT("/v1/shots/{shot}/focus-curve", { params: filled, body: body as unknown as { file: string } });
    }
    case "keySetting":
      return sendSettingKey(client, view, command, terms);
  }
}

/** The three kinds of settings have their keys at addresses of their own. */
function sendSettingKey(
  client: Client<paths>,
  view: View,
  { of, setting, time, key }: Extract<Command, { readonly do: "keySetting" }>,
  terms: Terms,
): Promise<Answer<unknown>> {
  const query = { ...cameraOf(view), gesture: terms.gesture };
  const path = { shot: view.shot, attribute: setting as never };
  const [set, remove] = [
    { params: { path, query, header: headerOf(terms) } },
    { params: { path, query: { ...query, time }, header: headerOf(terms) } },
  ];
  switch (of) {
    case "focus":
      return key
        ? client.PUT(`${CAMERA_ADDRESS}/keys/{attribute}`, { ...set, body: key })
        : client.DELETE(`${CAMERA_ADDRESS}/keys/{attribute}`, remove);
    case "exposure":
      return key
        ? client.PUT(`${CAMERA_ADDRESS}/exposure/keys/{attribute}`, { ...set, body: key })
        : client.DELETE(`${CAMERA_ADDRESS}/exposure/keys/{attribute}`, remove);
    case "film":
      return key
        ? client.PUT(`${CAMERA_ADDRESS}/film/keys/{attribute}`, { ...set, body: key })
        : client.DELETE(`${CAMERA_ADDRESS}/film/keys/{attribute}`, remove);
  }
}

function sendOfPoint(
  client: Client<paths>,
  view: View,
  command: Extract<Command, { readonly name: string }>,
  terms: Terms,
): Promise<Answer<unknown>> {
  const [header, query] = [headerOf(terms), { ...cameraOf(view), gesture: terms.gesture }];
  const atTime = { ...query, time: terms.time };
  const path = { shot: view.shot, name: command.name };
  switch (command.do) {
    case "addPoint": {
      const body = { name: command.name, ...command.anchor };
      return client.POST(POINTS_ADDRESS, { params: { path, query: atTime, header }, body });
    }
    case "changePoint": {
      const params = { path, query: atTime, header };
      return client.PATCH(`${POINTS_ADDRESS}/{name}`, { params, body: pointIn(command) });
    }
    case "removePoint":
      return client.DELETE(`${POINTS_ADDRESS}/{name}`, { params: { path, query, header } });
    case "setKey": {
      const params = { path: { ...path, attribute: command.attribute }, query, header };
      return client.PUT(`${POINTS_ADDRESS}/{name}/keys/{attribute}`, { params, body: command.key });
    }
    case "removeKey": {
      const at = { ...query, time: command.time };
      const params = { path: { ...path, attribute: command.attribute }, query: at, header };
      return client.DELETE(`${POINTS_ADDRESS}/{name}/keys/{attribute}`, { params });
    }
  }
}

/**
 * What is tried, in the bodies that would edit it for good; null for nothing. What nobody tries by dragging has no place in it.
 */
export function triedIn(tried: readonly Trial[]): Json["UnsavedEdit"] | null {
  if (tried.length === 0) return null;
  const points: Record<string, Json["FocusPointEdit"]> = {};
  const places: Record<string, readonly [number, number]> = {};
  const keys: Json["UnsavedKey"][] = [];
  let camera: Pick<Json["UnsavedEdit"], "camera" | "focus" | "exposure" | "film"> = {};
  for (const trial of tried) {
    if (trial.do === "setLens") camera = { ...camera, camera: { ...camera.camera, ...lensIn(trial) } };
    else if (trial.do === "setFocus") camera = { ...camera, focus: { ...camera.focus, ...changeIn(trial) } };
    else if (trial.do === "setExposure") camera = { ...camera, exposure: { ...camera.exposure, ...changeIn(trial) } };
    else if (trial.do === "setFilm") camera = { ...camera, film: { ...camera.film, ...changeIn(trial) } };
    else if (trial.do === "changePoint") points[trial.name] = { ...points[trial.name], ...pointIn(trial) };
    else if (trial.do === "setKey") keys.push({ point: trial.name, attribute: trial.attribute, key: trial.key });
    else if (trial.do === "place") places[trial.name] = trial.at;
  }
  return { ...camera, points, places, keys };
}

function lensIn(command: Extract<Command, { readonly do: "setLens" }>): Json["CameraEdit"] {
  const { focusDistanceM, ...rest } = command.change;
  // The service says infinity as USD does: 0.
  const focus =
    focusDistanceM === undefined ? {} : { focusDistanceM: focusDistanceM === Infinity ? 0 : focusDistanceM };
  return { ...rest, ...focus, ...timeOf(command) };
}

function changeIn<Changed>(command: {
  readonly change: Changed;
  readonly time: number | null;
}): Changed & { time?: number } {
  return { ...command.change, ...timeOf(command) };
}

function pointIn(command: Extract<Command, { readonly do: "changePoint" }>): Json["FocusPointEdit"] {
  const { anchor, ...settings } = command.change;
  return { ...anchor, ...settings };
}

function timeOf({ time }: { readonly time: number | null }): { time?: number } {
  return time === null ? {} : { time };
}

function headerOf({ tag }: Terms): { "if-match"?: string } {
  return tag === null ? {} : { "if-match": tag };
}
