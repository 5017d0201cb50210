/** One open shot: its document, time, pictures and selection, and the gestures on them. */

import { computed, signal } from "@preact/signals";
import {
  setAttribute,
  setFocus,
  setFocusMode,
  setLens,
  toggleSettingKey,
  type FocusChange,
  type SimpleAttribute,
} from "../model/changes";
import type { KeyedSetting } from "../model/keys";
import type { PictureBox } from "../model/quality";
import {
  FOCUS_MODE_WORDS,
  inFrame,
  KEYED_ATTRIBUTES,
  keysOf,
  type FocusMode,
  type FocusNumber,
  type FocusPoint,
  type FocusSettings,
  type FocusSwitch,
  type Lens,
  type Note,
  type PointColor,
  type PointSharpness,
  type Readout,
  type Shot,
} from "../model/shot";
import { sameTime } from "../model/time";
import type { Service } from "../net/service";
import { readKeys, type ReadKeys } from "./current_keys";
import { CameraMoves } from "./camera_moves";
import { CameraPlaceReader } from "./camera_place";
import { ShotDocument } from "./document";
import type { Drag } from "./drag";
import { Comparison } from "./comparison";
import { CacheFiller } from "./cache_filler";
import { Downloads } from "./downloads";
import { Corrections } from "./corrections";
import { Crosshair } from "./crosshair";
import { KeyEditing } from "./key_editing";
import { CameraPhotography } from "./photography";
import { ExposureMaps } from "./exposure_maps";
import type { Fail } from "./fail";
import { FrameCache } from "./frame_cache";
import { FrameNotes } from "./frame_notes";
import type { Identity } from "./identity";
import { Mounting } from "./mounting";
import { Others } from "./others";
import { Picks, type Place } from "./picks";
import { Pictures } from "./pictures";
import { Playhead } from "./playhead";
import { PointEdits } from "./point_edits";
import { PointNames } from "./point_names";
import { Pulls, usualPull, type PullChoice } from "./pulls";
import { RingDesk, usualDesk, type DeskChoices } from "./ring_desk";
import { readSetting } from "./setting_state";
import { followSession } from "./session_follow";
import { TimeView } from "./time_view";
import { TopViewer } from "./top_view";
import { Waits } from "./waits";
import { Zoom } from "./zoom";

export class Session {
  readonly shot: Shot;
  readonly document: ShotDocument;
  readonly playhead: Playhead;
  readonly timeView: TimeView;
  readonly pictures: Pictures;
  readonly cache: FrameCache;
  readonly filler: CacheFiller;
  readonly photography: CameraPhotography;
  readonly pulls: Pulls;
  readonly pointNames = new PointNames();
  readonly pointEdits: PointEdits;
  readonly picks: Picks;
  readonly keys: KeyEditing;
  readonly corrections: Corrections;
  readonly downloads: Downloads;
  readonly mounting: Mounting;
  readonly topView: TopViewer;
  readonly frameNotes: FrameNotes;
  readonly desk: RingDesk;
  readonly cameraMoves: CameraMoves;
  readonly cameraPlace: CameraPlaceReader;
  readonly others: Others;
  /** What is waited for, in the shot and beside it. */
  readonly waits: Waits;
  readonly notes = signal<readonly Note[]>([]);
  /** Name of the selected focus point, which may be gone. */
  readonly selected = signal<string | null>(null);
  /** Moments of the shutter interval in pictures at rest. */
  readonly motion = signal(1);
  /** Where the pointer is on the picture, 0 to 1 from its top left corner; null where it is elsewhere. */
  readonly pointer = signal<Place | null>(null);
  readonly crosshair = new Crosshair();
  readonly zoom = new Zoom();
  readonly comparison: Comparison;
  readonly exposureMaps: ExposureMaps;
  /** What a finger has in place of Shift and Alt on keys: it selects several, and drags without snapping. */
  readonly touch = { several: signal(false), free: signal(false) };
  /** Where the sharpness of the picture is read: at the crosshair, or without it at the pointer. */
  readonly probed = computed(() => (this.crosshair.isHeld.value ? this.crosshair.at.value : this.pointer.value));
  /** Whether pictures come with focus maps. */
  readonly focusMaps = signal(false);
  /** Device pixels that the whole picture has on screen, or those of the delivered one where it is enlarged. */
  readonly box = signal<PictureBox | null>(null);

  /** Names of the groups of points that lists show folded. */
  readonly foldedGroups = signal<ReadonlySet<string>>(new Set());

  readonly #service: Service;
  readonly #stop: () => void;

  constructor(
    service: Service,
    shot: Shot,
    camera: string | null,
    time: number,
    fail: Fail,
    { noEdits, noPictures }: Pick<Identity, "noEdits" | "noPictures">,
    pullChoice: PullChoice = usualPull(),
    waits = new Waits(),
    deskChoices: DeskChoices = usualDesk(),
  ) {
    this.#service = service;
    this.waits = waits;
    this.shot = shot;
    this.playhead = new Playhead(shot.range, time, (at) => this.pictures.isFreeFor(at));
    this.timeView = new TimeView(this.playhead);
    this.document = new ShotDocument(service, shot, camera, this.playhead.time, fail, noEdits);
    this.cache = new FrameCache(service, this.document, this.playhead.time);
    this.pictures = new Pictures(service, this.document, fail, noPictures.peek(), this.cache);
    const readNow: ReadKeys = (owner) => readKeys(service, this.document, owner, this.playhead.time.peek());
    this.corrections = new Corrections(this.document, readNow, this.pointNames);
    this.photography = new CameraPhotography(
      service,
      this.document,
      this.corrections,
      () => this.playhead.time.value,
      fail,
    );
    this.pulls = new Pulls(this.document, this.playhead.time, this.pointNames, pullChoice);
    this.pointEdits = new PointEdits(this.document, this.playhead.time, this.selected, this.pointNames);
    this.picks = new Picks(service, this, fail);
    this.cameraPlace = new CameraPlaceReader(service, this.document, this.playhead.time, fail);
    this.keys = new KeyEditing(this, readNow, fail);
    this.playhead.watch(this.pictures.displayed);
    this.filler = new CacheFiller(service, this, fail);
    this.mounting = new Mounting(this.document);
    this.downloads = new Downloads(service, this);
    this.topView = new TopViewer(service, this.document, this.playhead.time, fail);
    this.cameraMoves = new CameraMoves(service, this, fail);
    this.frameNotes = new FrameNotes(service, this.document, this.playhead, fail);
    this.desk = new RingDesk(this.document, this.playhead, deskChoices, fail);
    this.comparison = new Comparison(service, this, fail);
    this.exposureMaps = new ExposureMaps(service, this, fail);
    this.others = new Others(service, this.document);
    this.#stop = followSession(this, service, fail);
  }

  get camera(): string | null {
    return this.document.view.camera;
  }

  /** Width over height of the picture. */
  get aspect(): number {
    const film = this.photography.current.value?.film;
    return film?.aspect ?? this.shot.cameras.find((camera) => camera.path === this.camera)?.aspect ?? 16 / 9;
  }

  readonly moving = computed(
    () => this.playhead.playing.value || this.playhead.scrubbing.value || this.document.dragging.value,
  );

  /** Whether the best picture of the present state is on screen. */
  readonly settled = computed(() => {
    const shown = this.pictures.displayed.value;
    return (
      shown !== null &&
      shown.stage === "final" &&
      shown.unsaved.length === 0 &&
      !this.moving.value &&
      this.document.pending.value === 0 &&
      shown.revision === this.document.revision.value &&
      sameTime(shown.time, this.playhead.time.value)
    );
  });

  /** The points that belong on the picture on screen. */
  readonly shownPoints = computed<readonly FocusPoint[]>(() => {
    const shown = this.pictures.displayed.value;
    return shown && !sameTime(shown.time, this.playhead.time.value) ? shown.points : this.document.points.value;
  });

  foldGroup(name: string, isFolded: boolean): void {
    const others = [...this.foldedGroups.value].filter((other) => other !== name);
    this.foldedGroups.value = new Set(isFolded ? [...others, name] : others);
  }

  /** Colours of the points by name. */
  readonly pointColors = computed<ReadonlyMap<string, PointColor>>(
    () => new Map(this.document.points.value.map(({ name, color }) => [name, color])),
  );

  /** How sharp a point is: with the unsaved changes of the lens where these are in the picture. */
  sharpnessOf(point: FocusPoint): PointSharpness {
    return this.document.readout.value?.pointSharpness?.get(point.name) ?? point.sharpness;
  }

  readonly selectedPoint = computed(
    () => this.document.points.value.find((point) => point.name === this.selected.value) ?? null,
  );

  /** Name of the selected focus point, where it is there. */
  readonly selectedName = computed(() => this.selectedPoint.value?.name ?? null);

  /** Gives a point that is there already the focus at this time. */
  pullTo(point: FocusPoint): void {
    this.selected.value = point.name;
    void this.pulls.pullTo(point, this.playhead.time.value);
  }

  setFocusMode(mode: FocusMode): Promise<boolean> {
    const before = this.document.readout.value?.focusMode ?? mode;
    return this.document.edit(`Focus ${FOCUS_MODE_WORDS[mode]}`, setFocusMode(mode, before));
  }

  setFocusSwitch(label: string, name: FocusSwitch, on: boolean, before: FocusSettings): void {
    void this.document.edit(label, setFocus({ [name]: on }, this.playhead.time.value, before));
  }

  setFocus(label: string, change: FocusChange, before: FocusSettings): void {
    void this.document.edit(label, setFocus(change, this.playhead.time.value, before));
  }

  dragFocus(label: string, name: FocusNumber, before: FocusSettings): Drag<number> {
    const time = this.playhead.time.value;
    return this.corrections.drag(label, { owner: { setting: name }, keys: before.keys[name] ?? [], time }, (value) =>
      setFocus({ [name]: value }, time, before),
    );
  }

  /** Whether the points are many that are to be sharp at once, so that a click adds one more. */
  readonly gathers = computed(() => {
    const mode = this.document.readout.value?.focusMode;
    return mode === "tiltPlane" || mode === "surface";
  });

  /** Goes to the next key of a point, or with -1 to the one before. */
  goToKey(point: FocusPoint, by: 1 | -1): void {
    const now = this.playhead.time.value;
    const times = KEYED_ATTRIBUTES.flatMap((attribute) => keysOf(point, attribute)).map((key) => key.time);
    const beyond = times.filter((time) => !sameTime(time, now) && Math.sign(time - now) === by);
    if (beyond.length > 0) this.playhead.goTo(by > 0 ? Math.min(...beyond) : Math.max(...beyond));
  }

  dragPoint(label: string, point: FocusPoint, attribute: SimpleAttribute): Drag<number> {
    const [time, pointNow] = [this.playhead.time.value, this.pointEdits.following(point)];
    return this.corrections.drag(
      label,
      { owner: { point: point.name, attribute }, keys: keysOf(point, attribute), time },
      (value) => setAttribute(point, attribute, value, time),
      (value) => async () => setAttribute(await pointNow(time), attribute, value, time),
    );
  }

  /** Sets or removes a key of a point where the playhead is, which stays there. */
  toggleKey(point: FocusPoint, attribute: SimpleAttribute): Promise<boolean> {
    this.playhead.pause();
    return this.pointEdits.toggleKey(point, attribute);
  }

  dragLens(label: string, name: keyof Lens, before: Readout): Drag<number> {
    const [time, curve] = [this.playhead.time.value, this.document.curve.value];
    const keys = this.document.focusSettings.value?.keys ?? {};
    return this.corrections.drag(label, { owner: { setting: name }, keys: keys[name] ?? [], time }, (value) =>
      setLens(name, value, time, before, curve, keys),
    );
  }

  /** Whether the focus points set the f-number, so that nobody else does. */
  readonly pointsSetStop = computed(
    () => this.document.readout.value?.focusMode !== "manual" && this.document.focusSettings.value?.solveStop === true,
  );

  /** Meters the light as things are now. */
  meter(): void {
    const { playhead, document, photography, selectedName } = this;
    photography.measure(playhead.time.value, document.revision.value, photography.meterMode.value, selectedName.value);
  }

  /** Sets or removes a key of a setting where the playhead is, which stays there. */
  toggleSettingKey(label: string, setting: KeyedSetting): Promise<boolean> {
    this.playhead.pause();
    const time = this.playhead.time.value;
    return this.document.edit(`Key of ${label}`, async () => {
      const { value, keys } = await readSetting(this.#service, this.document.view, setting, time);
      return toggleSettingKey(setting, value, time, keys);
    });
  }

  /** Resolves when all edits that were begun are made. */
  async idle(): Promise<void> {
    await this.picks.idle();
    await this.document.idle();
  }

  close(): void {
    this.desk.close();
    this.cameraMoves.cancel();
    this.#stop();
    this.playhead.pause();
    const { others, document, photography, topView, comparison, exposureMaps, filler, cache, pictures } = this;
    const parts = [others, document, photography, topView, comparison, exposureMaps, filler, cache, pictures];
    for (const part of [...parts, this.cameraPlace, this.frameNotes]) part.close();
  }

  /** Selects the next point that is in the picture. */
  selectNext(by: 1 | -1): void {
    const names = this.shownPoints.value.filter(inFrame).map((point) => point.name);
    if (names.length === 0) return;
    this.selected.value = names.at((names.indexOf(this.selected.value ?? "") + by) % names.length) ?? null;
  }
}
