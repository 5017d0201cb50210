/** A service whose answers a test sets, and which records what it is sent. */

import type { CameraPlace } from "@/model/camera_place";
import type { Change, Changes } from "@/model/changes";
import type { Choices } from "@/model/choices";
import type { Curve } from "@/model/curve";
import { withChanges, type NoteList } from "@/model/frame_notes";
import type { EditHistory } from "@/model/history";
import type { Who } from "@/model/identity";
import type { Keyed } from "@/model/keys";
import type { LensSummary } from "@/model/lens";
import type { Libraries, Photography } from "@/model/photography";
import type { CacheEngine, Quality } from "@/model/quality";
import type { FocusPoint, FocusSettings, Pick, Readout, Shot, ShotSummary } from "@/model/shot";
import { errorOf } from "@/net/errors";
import type { LiveListener, LiveLink, LivePicture, PictureRequest } from "@/net/live_link";
import type { Edit, EditResult, FromAbove, MapOfEdits, PictureOfEdits, PictureStates, Service } from "@/net/service";
import type { EditsListener, EventLink } from "@/net/shot_events";
import type { View } from "@/net/view";
import { point } from "./points";

export const SHOT: Shot = {
  id: "demo",
  name: "Demo",
  sizeBytes: 1,
  fileCount: 1,
  quarantine: null,
  range: { start: 1, end: 96, framesPerSecond: 24 },
  cameras: [{ path: "/cam", aspect: 2 }],
  cameraPaths: ["/cam"],
  defaultCamera: "/cam",
};

const READOUT: Readout = {
  fStop: 2,
  focalLengthMm: 50,
  focusDistanceM: 3,
  nearM: 2.9,
  farM: 3.1,
  hyperfocalM: 60,
  source: "camera",
  reason: "",
  focusMode: "manual",
  note: "",
  tiltDeg: 0,
  swingDeg: 0,
  lensName: "",
  lensModel: "thin",
  cocLimitMm: 0.03,
  closeFocusM: 0.5,
  pupilToFilmMm: [50, 55],
  pointSharpness: null,
};

/**
 * A focus map of 2 by 2 pixels that a service has encoded: circles -1.5, 0.25, 0.5 and 8 px of 0.1 mm; depths 1, 2 and 2.5 m, and
 * nothing.
 */
export const FOCUS_MAP: ArrayBuffer = Uint8Array.from(
  atob("AAAALXsid2lkdGgiOiAyLCAiaGVpZ2h0IjogMiwgImZpbG1NbVBlclB4IjogMC4xfXjaY2CAgAMHGBj219kzQbkMDQ0KCfYMDvYATBEFPQ=="),
  (letter) => letter.charCodeAt(0),
).buffer;

/** A state of the edits: all changes that led to it, and the label of the last edit. */
interface State {
  readonly done: Changes;
  readonly label: string;
}

export class FakeService implements Partial<Service> {
  /** All edits that were made, undone or not. */
  readonly made: Changes[] = [];
  #states: State[] = [{ done: [], label: "" }];
  #now = 0;
  /** Times of the focus maps that were asked for. */
  readonly mapRequests: number[] = [];
  readonly frames: { time: number; quality: Quality }[] = [];
  /** Requests for live pictures, and the listener that waits for them. */
  readonly requests: PictureRequest[] = [];
  listener: LiveListener | null = null;
  /** Times that others were told of without a request. */
  readonly looks: number[] = [];
  /** Who is told of edits. */
  editsListener: EditsListener | null = null;
  /** How often live pictures were given up. */
  cancelled = 0;
  /** Edits with a change of this type fail, as a whole. */
  failing: Change["type"] | null = null;
  /** State that answers have; null as where the service could not read any. */
  state: Omit<EditResult, "history" | "simplified" | "cameras"> | null = null;
  /** The shot as it was sent. */
  shot = SHOT;
  simplified: EditResult["simplified"] = [];
  /** The gesture of each edit. */
  readonly gestures: string[] = [];
  /** Keys of the camera's focus settings. */
  keyed: Keyed = {};
  /** Called with the changes of each edit that is made. */
  onMade: (changes: Changes) => void = () => undefined;
  /** Called for each edit, before it is made; a test may hold it up. */
  gate: () => Promise<void> = () => Promise.resolve();
  /** As `gate`, for each pick. */
  pickGate: () => Promise<void> = () => Promise.resolve();
  /** Whether there is something at each place of the picture; its anchor then has that place. */
  hits = true;
  points: FocusPoint[] = [];
  /** What the picture of a time depends on. */
  stateAt: (time: number) => string | null = () => "as shot";
  /** The frames for playing that were asked for, and what holds them up. */
  readonly cacheRequests: { time: number; engine: CacheEngine }[] = [];
  pictureRevision: () => string = () => "now";
  cacheGate: (time: number) => Promise<void> = () => Promise.resolve();

  /** As the interface that the editor asks; what a test does not need is not there. */
  get service(): Service {
    return this as unknown as Service;
  }

  /** The changes of the present state. */
  get done(): Changes {
    return this.#states[this.#now]?.done ?? [];
  }

  async edit(_: View, { label, gesture, changes }: Edit): Promise<EditResult> {
    await this.gate();
    this.gestures.push(gesture ?? "");
    if (changes.some(({ type }) => type === this.failing))
      throw errorOf(500, { code: "broken", detail: `no ${String(this.failing)}` });
    this.made.push(changes);
    this.onMade(changes);
    this.#comeTo([...this.done, ...changes], label);
    const nothing = { points: null, readout: null, focusSettings: null, photography: null, curve: null };
    const answer = { ...(this.state ?? nothing), simplified: this.simplified, cameras: created(changes) };
    return { ...answer, history: { ...(await this.history()), cameras: null } };
  }

  edits(_: string, listener: EditsListener): EventLink {
    this.editsListener = listener;
    return { close: () => (this.editsListener = null) };
  }

  /** Somebody else makes a change. */
  othersDo(change: Change): void {
    this.#comeTo([...this.done, change], "what the other did");
  }

  #comeTo(done: Changes, label: string): void {
    this.#states = [...this.#states.slice(0, this.#now + 1), { done, label }];
    this.#now = this.#states.length - 1;
  }

  history(): Promise<EditHistory> {
    const revision = (at: number): string | null => {
      const state = this.#states[at];
      return state ? JSON.stringify(state.done) : null;
    };
    return Promise.resolve({
      revision: revision(this.#now) ?? "",
      before: revision(this.#now - 1),
      after: revision(this.#now + 1),
      undo: this.#states[this.#now]?.label ?? "",
      redo: this.#states[this.#now + 1]?.label ?? "",
      cameras: [...this.shot.cameraPaths, ...created(this.done)],
      notesTag: this.#notes().notesTag,
    });
  }

  async undo(_: string, revision: string): Promise<EditHistory> {
    return this.#walk(-1, revision);
  }

  async redo(_: string, revision: string): Promise<EditHistory> {
    return this.#walk(1, revision);
  }

  async #walk(by: number, revision: string): Promise<EditHistory> {
    if ((await this.history()).revision !== revision) throw errorOf(412, { code: "changed_meanwhile", detail: "No." });
    this.#now += by;
    return this.history();
  }

  listen(): void {
    // It asks for no key, and keeps nobody waiting.
  }

  whoAmI(): Promise<Who> {
    return Promise.resolve({ id: "anyone", label: "anyone", scopes: ["edit", "render"], project: "*", endsAt: null });
  }

  shots(): Promise<ShotSummary[]> {
    return Promise.resolve([SHOT]);
  }

  trash(): Promise<[]> {
    return Promise.resolve([]);
  }

  choices(): Promise<Choices> {
    return Promise.resolve({ variantSets: [], payloads: [], complete: true });
  }

  lenses(): Promise<readonly LensSummary[]> {
    return Promise.resolve([{ name: "fifty" } as LensSummary]);
  }

  libraries(): Promise<Libraries> {
    return Promise.resolve({ films: [], bodies: [], shapes: [] });
  }

  open(): Promise<Shot> {
    const more = created(this.done);
    const cameras = [...this.shot.cameras, ...more.map((path) => ({ path, aspect: 2 }))];
    const defaultCamera = more[0] ?? this.shot.defaultCamera;
    return Promise.resolve({ ...this.shot, cameras, cameraPaths: cameras.map(({ path }) => path), defaultCamera });
  }

  forget(): void {
    // It keeps no tags.
  }

  live(_: View, listener: LiveListener): LiveLink {
    this.listener = listener;
    return {
      free: true,
      request: (request) => void this.requests.push(request),
      look: (time) => void this.looks.push(time),
      cancel: () => (this.cancelled += 1),
      close: () => (this.listener = null),
    };
  }

  /** A picture for the newest request comes, or for the one at an index. */
  async show(stage: LivePicture["stage"], index = -1, focusMap: ArrayBuffer | null = null): Promise<void> {
    const request = this.requests.at(index);
    if (!request || !this.listener) throw new Error("Nobody waits for a picture.");
    const scale = stage === "preview" ? 0.25 : 1;
    const { width, height, rays } = request.quality;
    const facts = { width: width * scale, height: height * scale, rays, share: Number(stage === "final"), tookMs: 80 };
    await this.listener.onPicture({ blob: new Blob([stage]), stage, ...facts, focusMap }, request);
  }

  async frame(_: View, time: number, quality: Quality): Promise<Blob> {
    this.frames.push({ time, quality });
    await new Promise((resolve) => setTimeout(resolve, 150));
    return new Blob(["picture"]);
  }

  pictureStates(_: View, start: number, end: number): Promise<PictureStates> {
    const times = Array.from({ length: end - start + 1 }, (_frame, k) => start + k);
    return Promise.resolve({ revision: "now", by: new Map(times.map((time) => [time, this.stateAt(time)])) });
  }

  async cacheFrame(
    _: View,
    time: number,
    _quality: Quality,
    engine: CacheEngine,
    abort?: AbortSignal,
  ): Promise<PictureOfEdits> {
    this.cacheRequests.push({ time, engine });
    await this.cacheGate(time);
    if (abort?.aborted) throw new DOMException("aborted", "AbortError");
    return { blob: new Blob([`cached ${time}`]), revision: this.pictureRevision() };
  }

  focusMap(_: View, time: number): Promise<MapOfEdits> {
    this.mapRequests.push(time);
    return Promise.resolve({ data: FOCUS_MAP, revision: this.pictureRevision() });
  }

  focusSettings(): Promise<FocusSettings> {
    return Promise.resolve({ keys: this.keyed } as unknown as FocusSettings);
  }

  /** Keys of the camera's place, and what else is told of that. */
  place: CameraPlace = { keys: [], isEdited: false, isInShot: true };

  fromAbove = { cameraPlace: (): Promise<CameraPlace> => Promise.resolve(this.place) } as unknown as FromAbove;

  focusPoints(): Promise<FocusPoint[]> {
    return Promise.resolve(this.points);
  }

  async pick(_: View, _time: number, at: readonly [number, number]): Promise<Pick | null> {
    await this.pickGate();
    return this.hits ? { anchor: { ...point("thing").anchor, barycentric: [...at, 0] }, depthM: 2 } : null;
  }

  frameNotes(): Promise<NoteList> {
    return Promise.resolve(this.#notes());
  }

  #notes(): NoteList {
    const notes = withChanges([], this.done);
    return { notes, notesTag: notes.length > 0 ? JSON.stringify(notes) : "" };
  }

  notes(): Promise<[]> {
    return Promise.resolve([]);
  }

  curve(): Promise<Curve> {
    return Promise.resolve([]);
  }

  photography(): Promise<Photography> {
    return Promise.resolve({ exposure: { keys: {} }, film: { keys: {} } } as unknown as Photography);
  }

  readout(): Promise<Readout> {
    return Promise.resolve(READOUT);
  }
}

/** Prim paths of the cameras that changes create. */
function created(changes: Changes): string[] {
  return changes.flatMap((change) => (change.type === "createCamera" ? [`/${change.name ?? "main_cam"}`] : []));
}

/** Lets everything that waits for nothing but its turn happen. */
export async function turn(): Promise<void> {
  await new Promise((resolve) => setTimeout(resolve));
}
