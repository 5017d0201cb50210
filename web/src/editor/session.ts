/** One open shot: its document, time, pictures and selection, and the gestures on them. */

import { batch, computed, effect, signal } from "@preact/signals";
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
import { restQuality } from "../model/quality";
import {
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
import { ShotDocument } from "./document";
import type { Drag } from "./drag";
import { CacheFiller } from "./cache_filler";
import { Downloads } from "./downloads";
import { Corrections } from "./corrections";
import { Crosshair } from "./crosshair";
import { KeyEditing } from "./key_editing";
import { CameraPhotography } from "./photography";
import type { Fail } from "./fail";
import { FrameCache } from "./frame_cache";
import type { Identity } from "./identity";
import { Mounting } from "./mounting";
import { Picks, type Place } from "./picks";
import { Pictures } from "./pictures";
import { Playhead } from "./playhead";
import { PointEdits } from "./point_edits";
import { PointNames } from "./point_names";
import { Pulls, usualPull, type PullChoice } from "./pulls";
import { readSetting } from "./setting_state";
import { followWaits } from "./session_waits";
import { TimeView } from "./time_view";
import { Waits } from "./waits";

const MODE_NAMES: Readonly<Record<FocusMode, string>> = {
  manual: "by hand",
  points: "by points",
  tiltPlane: "by a tilted plane",
  surface: "by a surface",
};

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
  /** What a finger has in place of Shift and Alt on keys: it selects several, and drags without snapping. */
  readonly touch = { several: signal(false), free: signal(false) };
  /** Where the sharpness of the picture is read: at the crosshair, or without it at the pointer. */
  readonly probed = computed(() => (this.crosshair.isHeld.value ? this.crosshair.at.value : this.pointer.value));
  /** Whether pictures come with focus maps. */
  readonly focusMaps = signal(false);
  /** Device pixels that the picture has on screen. */
  readonly box = signal<{ readonly width: number; readonly height: number } | null>(null);

  /** Names of the groups of points that lists show folded. */
  readonly foldedGroups = signal<ReadonlySet<string>>(new Set());

  readonly #service: Service;
  readonly #fail: Fail;
  readonly #stop: () => void;
  #hasReadNotes = false;

  constructor(
    service: Service,
    shot: Shot,
    camera: string | null,
    time: number,
    fail: Fail,
    { noEdits, noPictures }: Pick<Identity, "noEdits" | "noPictures">,
    pullChoice: PullChoice = usualPull(),
    waits = new Waits(),
  ) {
    this.#service = service;
    this.#fail = fail;
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
    this.keys = new KeyEditing(this, readNow, fail);
    this.playhead.watch(this.pictures.displayed);
    this.filler = new CacheFiller(service, this, fail);
    this.mounting = new Mounting(this.document);
    this.downloads = new Downloads(service, this);
    const [unfollow, unwait] = [this.#follow(), followWaits(waits, this)];
    this.#stop = () => {
      unfollow();
      unwait();
    };
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
    return this.document.edit(`Focus ${MODE_NAMES[mode]}`, setFocusMode(mode, before));
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
    this.#stop();
    this.playhead.pause();
    this.document.close();
    this.photography.close();
    this.filler.close();
    this.cache.close();
    this.pictures.close();
  }

  /** Reads what the present state needs, whenever it changes. */
  #follow(): () => void {
    void this.document.catchUp();
    const stops = [
      effect(() => {
        this.document.follow(this.playhead.time.value, this.moving.value, this.document.revision.value);
      }),
      effect(() => {
        const [box, time, revision] = [this.box.value, this.playhead.time.value, this.document.revision.value];
        const [unsaved, motion, focusMaps] = [this.document.unsaved.value, this.motion.value, this.focusMaps.value];
        // While an edit is under way the next request follows soon.
        const moving = this.moving.value || this.document.pending.value > 0;
        if (!box) return;
        const quality = restQuality(box.width, box.height, motion);
        this.pictures.request({ time, revision, unsaved, moving, focusMaps, quality });
      }),
      this.selected.subscribe(() => {
        this.keys.clear(); // what is removed or moved next is what was selected last
      }),
      effect(() => {
        this.photography.follow(this.playhead.time.value, this.moving.value, this.document.revision.value);
      }),
      effect(() => {
        // Not at each step of a drag: the next step would wait for it.
        const revision = this.document.revision.value;
        if (!this.document.dragging.value) this.document.refreshCurve(revision);
      }),
      effect(() => {
        // Last of all, since it reads the whole shot; once.
        if ((this.settled.value || this.pictures.refusal !== null) && !this.#hasReadNotes) {
          this.#hasReadNotes = true;
          void this.#readNotes();
        }
      }),
    ];
    return () => {
      for (const stop of stops) stop();
    };
  }

  async #readNotes(): Promise<void> {
    try {
      this.notes.value = await this.#service.notes(this.shot.id);
    } catch (error) {
      this.#fail(error, () => void this.#readNotes());
    }
  }

  /** Selects the next point that is in the picture. */
  selectNext(by: 1 | -1): void {
    const names = this.shownPoints.value.filter(inFrame).map((point) => point.name);
    if (names.length === 0) return;
    const at = names.indexOf(this.selected.value ?? "");
    batch(() => (this.selected.value = names[(at + by + names.length) % names.length] ?? null));
  }
}
