/** Exposure, film and meter of the camera of an open shot, read at its time and revision, and their edits. */

import { computed, signal } from "@preact/signals";
import {
  matchShutter,
  setExposureStop,
  setShutter,
  type ExposureChange,
  type ExposureNumber,
  type ExposureSettings,
  type FilmChange,
  type FilmNumber,
  type FilmSettings,
  type GradeChoices,
  type MeterRequest,
  type MeterMode,
  type MeterReading,
  type Photography,
} from "../model/photography";
import { setExposure, setFilm } from "../model/changes";
import { frameDrawn } from "../net/frame_drawn";
import { NewestWins } from "../net/newest";
import type { Service } from "../net/service";
import type { Corrections } from "./corrections";
import type { At, ShotDocument } from "./document";
import type { Drag } from "./drag";
import type { Fail } from "./fail";

export class CameraPhotography {
  /** The settings as last read. */
  readonly current = signal<(Photography & At) | null>(null);
  readonly meter = signal<(MeterReading & At) | null>(null);
  readonly grades = signal<GradeChoices | null>(null);
  /** Whether the settings are being read. */
  readonly reading = signal(false);
  /** Whether the light is being metered. */
  readonly metering = signal(false);
  /** Mode of the meter where it does not set the exposure. */
  readonly meterMode = signal<MeterMode>("center");

  readonly #document: ShotDocument;
  readonly #time: () => number;
  readonly #follow: NewestWins<At, Photography>;
  readonly #followMeter: NewestWins<At & { request: MeterRequest | null }, MeterReading>;
  readonly #service: Service;
  readonly #corrections: Corrections;
  readonly #fail: Fail;

  constructor(service: Service, document: ShotDocument, corrections: Corrections, time: () => number, fail: Fail) {
    this.#service = service;
    this.#document = document;
    this.#corrections = corrections;
    this.#time = time;
    this.#fail = fail;
    const onError = (error: unknown): void => {
      fail(error, () => {
        document.refresh();
      });
    };
    this.#follow = new NewestWins({
      load: (at, signal) => service.photography(document.view, at.time, signal),
      onResult: (value, at) => (this.current.value = { ...value, ...at }),
      onError,
      onBusy: (isBusy) => (this.reading.value = isBusy),
      pause: frameDrawn,
      mostInFlight: 1,
    });
    this.#followMeter = new NewestWins({
      load: ({ time, request }, signal) => service.meter(document.view, time, request, signal),
      onResult: (value, { time, revision }) => (this.meter.value = { ...value, time, revision }),
      onError,
      onBusy: (isBusy) => (this.metering.value = isBusy),
      mostInFlight: 1,
    });
  }

  /** Whether the settings are of the present revision. */
  readonly fresh = computed(
    () => this.#document.pending.value === 0 && this.current.value?.revision === this.#document.revision.value,
  );

  follow(time: number, moving: boolean, revision: number): void {
    // While something moves the dragged value is shown, and the rest can wait.
    if (!this.#document.hasLens || (moving && this.current.peek() !== null)) return;
    const at = { time, revision };
    const photography = this.#document.resultOf(at)?.photography;
    if (photography) {
      this.#follow.clear(); // a reading under way is of an earlier revision
      this.current.value = { ...photography, ...at };
    } else this.#follow.load(at);
  }

  /**
   * Meters the light, on the device that draws the pictures: so it comes last.
   *
   * @param point name of the focus point that a spot is on; null for the camera's own spot.
   */
  measure(time: number, revision: number, mode: MeterMode, point: string | null): void {
    if (!this.#document.hasLens) return;
    const decides = this.current.peek()?.exposure.meteringMode !== "manual";
    const request = decides ? null : { mode, point: mode === "spot" ? point : null };
    this.#followMeter.load({ time, revision, request });
  }

  /** Stops metering; what was read before stays. */
  stopMeter(): void {
    this.#followMeter.clear();
  }

  /** Reads the grades to choose from, once. */
  readGrades(): void {
    if (!this.#document.hasLens || this.grades.peek()) return;
    this.#service
      .grades(this.#document.view, this.#time())
      .then((grades) => (this.grades.value = grades))
      .catch((error: unknown) => {
        this.#fail(error, () => {
          this.readGrades();
        });
      });
  }

  setExposure(label: string, change: ExposureChange, before: ExposureSettings): void {
    void this.#document.edit(label, setExposure(change, this.#time(), before));
  }

  dragExposure(label: string, name: ExposureNumber, before: ExposureSettings): Drag<number> {
    const time = this.#time();
    return this.#corrections.drag(label, { owner: { setting: name }, keys: before.keys[name] ?? [], time }, (value) =>
      setExposure({ [name]: value }, time, before),
    );
  }

  dragShutter(before: ExposureSettings): Drag<number> {
    const time = this.#time();
    return this.#document.drag("shutter", (value: number) => setExposure(setShutter(value, before), time, before));
  }

  /** Exposes for as long as the shutter is open. */
  matchShutter({ exposure, readout }: Photography): void {
    this.setExposure("Expose for the shutter’s time", matchShutter(exposure, readout), exposure);
  }

  setExposureStop(stop: ExposureSettings["exposureStop"], before: ExposureSettings, irisFStop: number): void {
    const label = stop === "iris" ? "Expose by the iris" : "Expose by a stop of its own";
    this.setExposure(label, setExposureStop(stop, before, irisFStop), before);
  }

  setFilm(label: string, change: FilmChange, before: FilmSettings): void {
    void this.#document.edit(label, setFilm(change, this.#time(), before));
  }

  dragFilm(label: string, name: FilmNumber, before: FilmSettings): Drag<number> {
    const time = this.#time();
    return this.#corrections.drag(label, { owner: { setting: name }, keys: before.keys[name] ?? [], time }, (value) =>
      setFilm({ [name]: value }, time, before),
    );
  }

  close(): void {
    this.#follow.clear();
    this.#followMeter.clear();
  }
}
