/** The service over REST, by its OpenAPI document: `npm run types` writes `schema.d.ts` from it. */

import createClient, { type Client } from "openapi-fetch";
import type { Command } from "../model/command";
import type { Curve } from "../model/curve";
import type { LensSummary } from "../model/lens";
import type { Quality } from "../model/quality";
import type { FocusPoint, Note, Pick, Readout, Shot, ShotSummary } from "../model/shot";
import { toCurve, toLens, toPick, toPoint, toReadout, toShot, toSummary, type Json } from "./convert";
import { errorOf, isAbort, UnreachableError } from "./errors";
import type { paths } from "./schema";
import type { CurveFormat, Download, PictureFormat, Service, View } from "./service";
import { sendFile } from "./upload";

/** What openapi-fetch resolves to: one of the two is there. */
interface Answer<Data> {
  readonly data?: Data;
  readonly error?: unknown;
  readonly response: Response;
}

export class HttpService implements Service {
  readonly #base: string;
  readonly #client: Client<paths>;

  /** @param base address of the service, without a slash at its end; empty for where the page came from. */
  constructor(base = "") {
    this.#base = base;
    this.#client = createClient<paths>({ baseUrl: base });
  }

  async shots(): Promise<ShotSummary[]> {
    const { shots } = await result(this.#client.GET("/v1/shots"));
    return shots.map(toSummary);
  }

  async upload(file: File, onProgress: (fraction: number) => void, signal: AbortSignal): Promise<ShotSummary> {
    return toSummary((await sendFile(`${this.#base}/v1/shots`, file, onProgress, signal)) as Json["Shot"]);
  }

  async removeShot(shot: string): Promise<void> {
    await done(this.#client.DELETE("/v1/shots/{shot}", { params: { path: { shot } } }));
  }

  async open(shot: string): Promise<Shot> {
    const path = { shot };
    const json = await result(this.#client.GET("/v1/shots/{shot}", { params: { path } }));
    const query = { time: json.frameRange.start };
    return toShot(json, await result(this.#client.GET("/v1/shots/{shot}/cameras", { params: { path, query } })));
  }

  async lenses(): Promise<readonly LensSummary[]> {
    const { lenses } = await result(this.#client.GET("/v1/lenses"));
    return lenses.map((lens) => toLens(lens, this.#base));
  }

  async revision(shot: string): Promise<string> {
    const asked = this.#client.GET("/v1/shots/{shot}", { params: { path: { shot } } });
    return (await result(asked)).revision;
  }

  async notes(shot: string): Promise<readonly Note[]> {
    const asked = this.#client.GET("/v1/shots/{shot}/inspect", { params: { path: { shot } } });
    return (await result(asked)).notes;
  }

  async frame(view: View, time: number, quality: Quality, signal?: AbortSignal): Promise<Blob> {
    return this.#picture(view, { ...pictureOf(time, quality), format: quality.format }, signal);
  }

  async focusPoints(view: View, time: number, signal?: AbortSignal): Promise<FocusPoint[]> {
    const asked = this.#client.GET("/v1/shots/{shot}/focus-points", { ...at(view, { time }), ...abortable(signal) });
    return (await result(asked)).focusPoints.map(toPoint);
  }

  async readout(view: View, time: number, signal?: AbortSignal): Promise<Readout> {
    const asked = this.#client.GET("/v1/shots/{shot}/readout", { ...at(view, { time }), ...abortable(signal) });
    return toReadout(await result(asked));
  }

  async curve(view: View, signal?: AbortSignal): Promise<Curve> {
    const query = at(view, { format: "json" as const });
    const asked = this.#client.GET("/v1/shots/{shot}/focus-curve", { ...query, ...abortable(signal) });
    return toCurve((await result(asked)) as Json["FocusCurve"]);
  }

  async pick(view: View, time: number, place: readonly [number, number], quality: Quality): Promise<Pick | null> {
    const { width, height } = quality;
    const body = { ...cameraOf(view), time, width, height, x: place[0] * width, y: place[1] * height };
    const path = { shot: view.shot };
    return toPick(await result(this.#client.POST("/v1/shots/{shot}/pick", { params: { path }, body })));
  }

  async perform(view: View, command: Command, time: number): Promise<void> {
    const query = { ...cameraOf(view), time };
    switch (command.do) {
      case "setLens": {
        const { focusDistanceM, ...rest } = command.change;
        // The service says infinity as USD does: 0.
        const focus =
          focusDistanceM === undefined ? {} : { focusDistanceM: focusDistanceM === Infinity ? 0 : focusDistanceM };
        const body = { ...rest, ...focus, ...(command.time === null ? {} : { time: command.time }) };
        return done(this.#client.PATCH("/v1/shots/{shot}/camera", { ...at(view, {}), body }));
      }
      case "addPoint": {
        const body = { name: command.name, ...command.anchor, ...command.settings };
        return done(this.#client.POST("/v1/shots/{shot}/focus-points", { ...at(view, { time }), body }));
      }
      case "changePoint": {
        const { anchor, ...settings } = command.change;
        const params = { path: { shot: view.shot, name: command.name }, query };
        const body = { ...anchor, ...settings };
        return done(this.#client.PATCH("/v1/shots/{shot}/focus-points/{name}", { params, body }));
      }
      case "removePoint": {
        const params = { path: { shot: view.shot, name: command.name }, query };
        return done(this.#client.DELETE("/v1/shots/{shot}/focus-points/{name}", { params }));
      }
      case "setKey":
      case "removeKey":
        return this.#performKey(view, command);
      case "mountLens":
        return done(this.#client.PATCH("/v1/shots/{shot}/camera", { ...at(view, {}), body: { lens: command.lens } }));
      case "mountLensFile": {
        const body = new FormData();
        body.append("file", command.file);
        // The document has the file as text; what travels is the form.
        const options = { ...at(view, {}), body: body as unknown as { file: string } };
        return done(this.#client.PUT("/v1/shots/{shot}/camera/lens", options));
      }
      case "restoreEdits": {
        const params = { path: { shot: view.shot } };
        return done(this.#client.PUT("/v1/shots/{shot}/edits", { params, body: { revision: command.revision } }));
      }
    }
  }

  async downloadFrame(view: View, time: number, quality: Quality, format: PictureFormat): Promise<Download> {
    const blob = await this.#picture(view, { ...pictureOf(time, quality), format });
    return { blob, name: `${view.shot}.${time.toString().padStart(4, "0")}.${format}` };
  }

  async downloadCurve(view: View, format: CurveFormat): Promise<Download> {
    const options = { ...at(view, { format }), parseAs: "blob" as const };
    const blob = await result<Blob>(this.#client.GET("/v1/shots/{shot}/focus-curve", options));
    return { blob, name: `${view.shot}.focus.${format}` };
  }

  async downloadEdits(shot: string): Promise<Download> {
    const options = { params: { path: { shot } }, parseAs: "blob" as const };
    const blob = await result<Blob>(this.#client.GET("/v1/shots/{shot}/edits", options));
    return { blob, name: `${shot}.edits.usda` };
  }

  async #performKey(view: View, command: Extract<Command, { do: "setKey" | "removeKey" }>): Promise<void> {
    const path = { shot: view.shot, name: command.name, attribute: command.attribute };
    const query = cameraOf(view);
    const address = "/v1/shots/{shot}/focus-points/{name}/keys/{attribute}";
    if (command.do === "setKey") return done(this.#client.PUT(address, { params: { path, query }, body: command.key }));
    return done(this.#client.DELETE(address, { params: { path, query: { ...query, time: command.time } } }));
  }

  async #picture(view: View, asked: PictureQuery, signal?: AbortSignal): Promise<Blob> {
    const options = { ...at(view, asked), ...abortable(signal), parseAs: "blob" as const };
    return result<Blob>(this.#client.GET("/v1/shots/{shot}/frame", options));
  }
}

type PictureQuery = paths["/v1/shots/{shot}/frame"]["get"]["parameters"]["query"];

function pictureOf(time: number, { width, height, rays, layers, supersample }: Quality): PictureQuery {
  return { time, width, height, rays, layers, supersample };
}

/** The camera as a parameter: left out, the service takes the shot's own. */
function cameraOf(view: View): { camera?: string } {
  return view.camera === null ? {} : { camera: view.camera };
}

function at<Query extends object>(
  view: View,
  query: Query,
): { params: { path: { shot: string }; query: Query & { camera?: string } } } {
  return { params: { path: { shot: view.shot }, query: { ...query, ...cameraOf(view) } } };
}

function abortable(signal: AbortSignal | undefined): { signal?: AbortSignal } {
  return signal ? { signal } : {};
}

async function result<Data>(asked: Promise<Answer<Data>>): Promise<Data> {
  const answer = await reached(asked);
  if (!answer.response.ok) throw errorOf(answer.response.status, answer.error);
  return answer.data as Data;
}

async function done(asked: Promise<Answer<unknown>>): Promise<void> {
  await result(asked);
}

/** What fetch throws when nothing answers says little to a person. */
async function reached<Data>(asked: Promise<Answer<Data>>): Promise<Answer<Data>> {
  try {
    return await asked;
  } catch (error) {
    throw isAbort(error) || !(error instanceof TypeError) ? error : new UnreachableError();
  }
}
