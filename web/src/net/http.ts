/** The service over REST, by its OpenAPI document: `npm run types` writes `schema.d.ts` from it. */

import createClient, { type Client } from "openapi-fetch";
import type { Choices } from "../model/choices";
import type { Curve } from "../model/curve";
import type { NoteList } from "../model/frame_notes";
import type { EditHistory } from "../model/history";
import type { Who } from "../model/identity";
import type { LensSummary } from "../model/lens";
import type { GradeChoices, Libraries, MeterRequest, MeterReading, Photography } from "../model/photography";
import type { CacheEngine, PictureSize, Quality } from "../model/quality";
import type { FocusPoint, FocusSettings, Note, Pick, Readout, Shot, ShotSummary, TrashedShot } from "../model/shot";
import { done, refusalIn, REFUSED_FOR_NOW, result } from "./answers";
import {
  toCurve,
  toEditResult,
  toFilm,
  toFocusSettings,
  toHistory,
  toLens,
  toPhotography,
  toPick,
  toPoint,
  toReading,
  toReadout,
  toShot,
  toSummary,
  type Json,
} from "./convert";
import { HttpFromAbove } from "./from_above";
import { LiveSocket, liveAddress } from "./live";
import type { LiveListener, LiveLink } from "./live_link";
import { Patience, type PatienceListener } from "./patience";
import { HttpRenders } from "./renders";
import type { paths } from "./schema";
import type {
  CurveFormat,
  Download,
  Edit,
  EditResult,
  MapOfEdits,
  PictureFormat,
  PictureOfEdits,
  PictureStates,
  Sending,
  Service,
} from "./service";
import { abortable, at, ifStill, meterOf, pictureOf, type PictureQuery } from "./queries";
import { CAMERA, noteAddress, pointAddress, POINTS, TagBooks } from "./tags";
import { ShotEvents, shotEventsAddress, type EditsListener, type EventLink } from "./shot_events";
import { sendFile } from "./upload";
import { cameraOf, type View } from "./view";

export class HttpService implements Service {
  readonly renders: HttpRenders;
  readonly fromAbove: HttpFromAbove;
  readonly #base: string;
  readonly #client: Client<paths>;
  readonly #patience = new Patience();
  /** By shot and camera. */
  readonly #tags = new TagBooks();

  /** @param base address of the service, without a slash at its end; empty for where the page came from. */
  constructor(base = "") {
    this.#base = base;
    this.#client = createClient<paths>({ baseUrl: base, fetch: (request) => this.#send(request) });
    this.renders = new HttpRenders(this.#client, base);
    this.fromAbove = new HttpFromAbove(this.#client);
  }

  listen(listener: PatienceListener): void {
    this.#patience.listener = listener;
  }

  async whoAmI(): Promise<Who> {
    return result(this.#client.GET("/v1/session"));
  }

  async signIn(key: string): Promise<Who> {
    // A wrong key is told, and not asked for again by the request itself.
    return result(this.#client.POST("/v1/session", { body: { key }, fetch }));
  }

  async signOut(): Promise<void> {
    await done(this.#client.DELETE("/v1/session"));
  }

  async shots(): Promise<ShotSummary[]> {
    const { shots } = await result(this.#client.GET("/v1/shots"));
    return shots.map(toSummary);
  }

  async upload(
    { file, root }: Sending,
    onProgress: (fraction: number) => void,
    signal: AbortSignal,
  ): Promise<ShotSummary> {
    const [address, fields] = [`${this.#base}/v1/shots`, root === null ? {} : { root }];
    const attempt = (): Promise<unknown> => sendFile(address, file, fields, onProgress, signal);
    return toSummary((await this.#patience.send(attempt, false, signal)) as Json["Shot"]);
  }

  async removeShot(shot: string): Promise<void> {
    await done(this.#client.DELETE("/v1/shots/{shot}", { params: { path: { shot } } }));
  }

  async trash(): Promise<readonly TrashedShot[]> {
    return (await result(this.#client.GET("/v1/trash"))).shots;
  }

  async restore(entry: string): Promise<ShotSummary> {
    const params = { path: { trashed: entry } };
    return toSummary(await result(this.#client.POST("/v1/trash/{trashed}/restore", { params })));
  }

  async release(shot: string): Promise<void> {
    await done(this.#client.DELETE("/v1/shots/{shot}/quarantine", { params: { path: { shot } } }));
  }

  async open(shot: string, signal?: AbortSignal): Promise<Shot> {
    const [path, giveUp] = [{ shot }, abortable(signal)];
    const json = await result(this.#client.GET("/v1/shots/{shot}", { params: { path }, ...giveUp }));
    const params = { path, query: { time: json.frameRange.start } };
    return toShot(json, await result(this.#client.GET("/v1/shots/{shot}/cameras", { params, ...giveUp })));
  }

  choices(shot: string, signal?: AbortSignal): Promise<Choices> {
    return result(this.#client.GET("/v1/shots/{shot}/choices", { params: { path: { shot } }, ...abortable(signal) }));
  }

  async frameNotes(view: View, signal?: AbortSignal): Promise<NoteList> {
    const [read, path] = [this.#tags.of(view).reading(), { shot: view.shot }];
    const list = await result(this.#client.GET("/v1/shots/{shot}/notes", { params: { path }, ...abortable(signal) }));
    for (const note of list.notes) read(noteAddress(note.id), note.etag);
    return list;
  }

  async lenses(): Promise<readonly LensSummary[]> {
    const { lenses } = await result(this.#client.GET("/v1/lenses"));
    return lenses.map((lens) => toLens(lens, this.#base));
  }

  async libraries(): Promise<Libraries> {
    const [{ films }, { bodies, shapes }] = await Promise.all([
      result(this.#client.GET("/v1/films")),
      result(this.#client.GET("/v1/bodies")),
    ]);
    return { films: films.map((film) => toFilm(film, this.#base)), bodies, shapes };
  }

  async photography(view: View, time: number, signal?: AbortSignal): Promise<Photography> {
    const read = this.#tags.of(view).reading();
    const options = { ...at(view, { time }), ...abortable(signal) };
    const [exposure, film, readout] = await Promise.all([
      result(this.#client.GET("/v1/shots/{shot}/camera/exposure", options)),
      result(this.#client.GET("/v1/shots/{shot}/camera/film", options)),
      result(this.#client.GET("/v1/shots/{shot}/readout/exposure", options)),
    ]);
    if (exposure.etag === film.etag) read(CAMERA, film.etag);
    return toPhotography(exposure, film, readout);
  }

  async meter(view: View, time: number, request: MeterRequest | null, signal?: AbortSignal): Promise<MeterReading> {
    const options = { ...at(view, meterOf(time, request)), ...abortable(signal) };
    return toReading(await result(this.#client.GET("/v1/shots/{shot}/meter", options)));
  }

  async grades(view: View, time: number): Promise<GradeChoices> {
    return result(this.#client.GET("/v1/shots/{shot}/camera/grades", at(view, { time })));
  }

  async history(shot: string): Promise<EditHistory> {
    const answer = this.#client.GET("/v1/shots/{shot}/edits/history", { params: { path: { shot } } });
    return toHistory(await result(answer));
  }

  async undo(shot: string, revision: string): Promise<EditHistory> {
    const answer = this.#client.POST("/v1/shots/{shot}/edits/undo", ifStill(shot, revision));
    return this.#tags.asWhole(shot, async () => toHistory(await result(answer)));
  }

  async redo(shot: string, revision: string): Promise<EditHistory> {
    const answer = this.#client.POST("/v1/shots/{shot}/edits/redo", ifStill(shot, revision));
    return this.#tags.asWhole(shot, async () => toHistory(await result(answer)));
  }

  async notes(shot: string): Promise<readonly Note[]> {
    const answer = this.#client.GET("/v1/shots/{shot}/inspect", { params: { path: { shot } } });
    return (await result(answer)).notes;
  }

  live(view: View, listener: LiveListener): LiveLink {
    const address = liveAddress(this.#base || location.origin, view.shot, listener.onOthers !== undefined);
    return new LiveSocket(address, view, listener, { admitted: () => this.whoAmI() });
  }

  edits(shot: string, listener: EditsListener): EventLink {
    const address = shotEventsAddress(this.#base || location.origin, shot);
    return new ShotEvents(address, listener, { admitted: () => this.whoAmI() });
  }

  async frame(view: View, time: number, quality: Quality, signal?: AbortSignal): Promise<Blob> {
    return this.#picture(view, { ...pictureOf(time, quality), format: quality.format, live: true }, signal);
  }

  async cacheFrame(
    view: View,
    time: number,
    quality: Quality,
    engine: CacheEngine,
    signal?: AbortSignal,
  ): Promise<PictureOfEdits> {
    const query = { ...pictureOf(time, quality), engine, format: quality.format, live: true };
    const options = { ...at(view, query), ...abortable(signal), parseAs: "blob" as const };
    const answer = await this.#client.GET("/v1/shots/{shot}/frame", options);
    const blob = await result<Blob>(Promise.resolve(answer));
    return { blob, revision: answer.response.headers.get("Pullfocus-Revision") ?? "" };
  }

  async focusMap(view: View, time: number, { width, height }: Quality, signal?: AbortSignal): Promise<MapOfEdits> {
    const options = { ...at(view, { time, width, height }), ...abortable(signal), parseAs: "arrayBuffer" as const };
    const answer = await this.#client.GET("/v1/shots/{shot}/focus-map", options);
    const data = await result<ArrayBuffer>(Promise.resolve(answer));
    return { data, revision: answer.response.headers.get("Pullfocus-Revision") ?? "" };
  }

  async exposureMap(view: View, time: number, size: PictureSize, signal?: AbortSignal): Promise<ArrayBuffer> {
    const options = { ...at(view, { time, ...size }), ...abortable(signal), parseAs: "arrayBuffer" as const };
    return result<ArrayBuffer>(this.#client.GET("/v1/shots/{shot}/exposure-map", options));
  }

  async pictureStates(view: View, start: number, end: number, signal?: AbortSignal): Promise<PictureStates> {
    const frames = `${start}:${end}`;
    const answer = this.#client.GET("/v1/shots/{shot}/picture-states", {
      ...at(view, { frames }),
      ...abortable(signal),
    });
    const { states, revision } = await result(answer);
    return { revision, by: new Map(states.map(({ time, state }) => [time, state])) };
  }

  async focusPoints(view: View, time: number, signal?: AbortSignal): Promise<FocusPoint[]> {
    const read = this.#tags.of(view).reading();
    const answer = this.#client.GET("/v1/shots/{shot}/focus-points", { ...at(view, { time }), ...abortable(signal) });
    const { focusPoints, etag } = await result(answer);
    read(POINTS, etag);
    for (const point of focusPoints) read(pointAddress(point.name), point.etag);
    return focusPoints.map(toPoint);
  }

  async focusSettings(view: View, time: number, signal?: AbortSignal): Promise<FocusSettings> {
    const read = this.#tags.of(view).reading();
    const answer = this.#client.GET("/v1/shots/{shot}/camera/focus", { ...at(view, { time }), ...abortable(signal) });
    const settings = await result(answer);
    read(CAMERA, settings.etag);
    return toFocusSettings(settings);
  }

  async readout(view: View, time: number, signal?: AbortSignal): Promise<Readout> {
    const answer = this.#client.GET("/v1/shots/{shot}/readout", { ...at(view, { time }), ...abortable(signal) });
    return toReadout(await result(answer));
  }

  async curve(view: View, signal?: AbortSignal): Promise<Curve> {
    const query = at(view, { format: "json" as const });
    const answer = this.#client.GET("/v1/shots/{shot}/focus-curve", { ...query, ...abortable(signal) });
    return toCurve((await result(answer)) as Json["FocusCurve"]);
  }

  async pick(
    view: View,
    time: number,
    place: readonly [number, number],
    quality: Quality,
    signal?: AbortSignal,
  ): Promise<Pick | null> {
    const { width, height } = quality;
    const body = { ...cameraOf(view), time, width, height, x: place[0] * width, y: place[1] * height };
    const path = { shot: view.shot };
    const options = { params: { path }, body, ...abortable(signal) };
    return toPick(await result(this.#client.POST("/v1/shots/{shot}/pick", options)));
  }

  async edit(view: View, { label, gesture, changes, time, withCurve }: Edit): Promise<EditResult> {
    const tags = this.#tags.of(view);
    const ifMatch = tags.ifMatch(changes);
    const params = { path: { shot: view.shot }, header: ifMatch === null ? {} : { "if-match": ifMatch } };
    const body = {
      ...cameraOf(view),
      label,
      ...(gesture !== undefined && { gesture }),
      changes,
      answer: { time, curve: withCurve },
    };
    tags.turn();
    try {
      const edited = await result(this.#client.POST("/v1/shots/{shot}/edits", { params, body }));
      tags.take(edited.changed);
      return toEditResult(edited);
    } catch (error) {
      tags.forget(changes);
      throw error;
    } finally {
      tags.turn();
    }
  }

  forget(shot: string): void {
    this.#tags.turn(shot);
  }

  async downloadFrame(
    view: View,
    time: number,
    quality: Quality,
    format: PictureFormat,
    signal?: AbortSignal,
  ): Promise<Download> {
    const blob = await this.#picture(view, { ...pictureOf(time, quality), format }, signal);
    return { blob, name: `${view.shot}.${time.toString().padStart(4, "0")}.${format}` };
  }

  async downloadCurve(view: View, format: CurveFormat, signal?: AbortSignal): Promise<Download> {
    const options = { ...at(view, { format }), ...abortable(signal), parseAs: "blob" as const };
    const blob = await result<Blob>(this.#client.GET("/v1/shots/{shot}/focus-curve", options));
    return { blob, name: `${view.shot}.focus.${format === "opentrackio" ? "opentrackio.json" : format}` };
  }

  async downloadEdits(shot: string, signal?: AbortSignal): Promise<Download> {
    const options = { params: { path: { shot } }, ...abortable(signal), parseAs: "blob" as const };
    const blob = await result<Blob>(this.#client.GET("/v1/shots/{shot}/edits", options));
    return { blob, name: `${shot}.edits.usda` };
  }

  async #send(request: Request): Promise<Response> {
    const attempt = async (): Promise<Response> => {
      const answer = await fetch(request.clone());
      if (REFUSED_FOR_NOW.includes(answer.status)) throw await refusalIn(answer);
      return answer;
    };
    return this.#patience.send(attempt, request.method === "GET", request.signal);
  }

  async #picture(view: View, query: PictureQuery, signal?: AbortSignal): Promise<Blob> {
    const options = { ...at(view, query), ...abortable(signal), parseAs: "blob" as const };
    return result<Blob>(this.#client.GET("/v1/shots/{shot}/frame", options));
  }
}
