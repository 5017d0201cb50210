/** How a camera takes the picture: its exposure, shutter, film and grade, and what a light meter says. */

import type { components } from "../net/schema";
import type { Keyed, KeyedSetting } from "./keys";
import { EXPOSURE_CHOICES } from "./settings.gen";

type Json = components["schemas"];
type NotSettings = "camera" | "time" | "etag" | "keys";

export type ExposureSettings = Omit<Json["ExposureSettings"], NotSettings> & { readonly keys: Keyed };

export type FilmSettings = Omit<Json["FilmSettings"], NotSettings> & {
  /** Width over height of the picture. */
  readonly aspect: number;
  readonly keys: Keyed;
};

export type ExposureNumber = Extract<NumbersOf<ExposureSettings>, KeyedSetting>;
export type FilmNumber = Extract<NumbersOf<FilmSettings>, KeyedSetting>;
type NumbersOf<Settings> = { [Name in keyof Settings]: Settings[Name] extends number ? Name : never }[keyof Settings];

export type ExposureChange = Partial<Omit<ExposureSettings, "keys">>;
export type FilmChange = Partial<
  Omit<FilmSettings, "keys" | "body" | "aspect" | "gateMm" | "ocioConfig" | "cdlFile" | "stock">
> & {
  /** A stock of the library, null for no film. */
  readonly stock?: string | null;
};

export const SHUTTER_TYPES = EXPOSURE_CHOICES.shutterType;
export type ShutterType = ExposureSettings["shutterType"];
export type MeteringMode = ExposureSettings["meteringMode"];
export type MeterMode = Exclude<MeteringMode, "manual">;
export type FilmProcess = FilmSettings["process"];

/** What the exposure is worth. */
export interface ExposureReadout {
  /** The stop that is exposed by. */
  readonly fStop: number;
  /** With what the glass takes and the bellows factor. */
  readonly effectiveTStop: number;
  readonly bellowsFactor: number;
  readonly ev100: number;
  readonly ndStops: number;
  readonly shutterTimeS: number;
  /** Luminance that comes out as middle grey. */
  readonly greyNits: number;
}

/** What a meter is to look at. */
export interface MeterRequest {
  readonly mode: MeterMode;
  /** Name of the focus point that a spot is on; null for the camera's own spot. */
  readonly point: string | null;
}

export interface MeterReading {
  readonly mode: MeterMode;
  /** Of a spot, in the picture. */
  readonly place: readonly [number, number] | null;
  readonly luminanceNits: number;
  /** Minus infinity for black, as `stops` is. */
  readonly ev100: number;
  readonly incidentLux: number;
  /** Over (or, negative, under) middle grey, as the camera is set. */
  readonly stops: number;
  /** In place of the camera's; null for black. */
  readonly compensationStops: number | null;
  /** Whether the meter decides, so that `stops` is made up for. */
  readonly decides: boolean;
}

/** All that is read of a camera's photography at one time. */
export interface Photography {
  readonly exposure: ExposureSettings;
  readonly film: FilmSettings;
  readonly readout: ExposureReadout;
}

export interface FilmSummary {
  readonly name: string;
  readonly title: string;
  readonly kind: "camera" | "print";
  readonly process: FilmProcess;
  /** ISO; null for a print stock. */
  readonly speed: number | null;
  readonly balanceK: number | null;
  readonly description: string;
  /** Address of a sheet about it. */
  readonly sheet: string;
}

export interface BodySummary {
  readonly name: string;
  readonly title: string;
  readonly kind: "film" | "digital";
  readonly gateMm: readonly [number, number];
  readonly squeeze: number;
  readonly description: string;
}

/** A shape that pictures are delivered in. */
export interface Shape {
  readonly name: string;
  readonly aspect: number;
}

/** What there is to choose from. */
export interface Libraries {
  readonly films: readonly FilmSummary[];
  readonly bodies: readonly BodySummary[];
  readonly shapes: readonly Shape[];
}

export const NO_LIBRARIES: Libraries = { films: [], bodies: [], shapes: [] };

export interface GradeChoices {
  readonly displays: readonly {
    readonly name: string;
    readonly views: readonly string[];
    readonly defaultView: string;
  }[];
  readonly defaultDisplay: string;
  readonly looks: readonly string[];
}

/** Whether the exposure is made for as long as the shutter is open. */
export function agrees(exposure: ExposureSettings, readout: ExposureReadout): boolean {
  return readout.shutterTimeS === 0 || Math.abs(exposure.exposureTimeS / readout.shutterTimeS - 1) < 0.005;
}

/** The shutter that a person sets: it blurs for longer and exposes for longer by the same factor. */
export function setShutter(angleDeg: number, before: ExposureSettings): ExposureChange {
  const was = before.shutterAngleDeg;
  const factor = was > 0 && angleDeg > 0 ? angleDeg / was : 1;
  return { shutterAngleDeg: angleDeg, exposureTimeS: before.exposureTimeS * factor };
}

/** Exposes for as long as the shutter is open; compensation keeps the picture as bright. */
export function matchShutter(exposure: ExposureSettings, readout: ExposureReadout): ExposureChange {
  const stops = Math.log2(exposure.exposureTimeS / readout.shutterTimeS);
  return { exposureTimeS: readout.shutterTimeS, compensationStops: exposure.compensationStops + stops };
}

/** Exposes by the iris, or by a stop of its own; compensation keeps the picture as bright. */
export function setExposureStop(
  stop: ExposureSettings["exposureStop"],
  exposure: ExposureSettings,
  irisFStop: number,
): ExposureChange {
  if (stop === "exposure")
    return { exposureStop: stop, exposureFStop: irisFStop > 0 ? irisFStop : exposure.exposureFStop };
  const stops = irisFStop > 0 ? 2 * Math.log2(irisFStop / exposure.exposureFStop) : 0;
  return { exposureStop: stop, compensationStops: exposure.compensationStops + stops };
}

const PROCESS_NAMES: Readonly<Record<Exclude<FilmProcess, "none" | "digital">, string>> = {
  negative: "Colour negative",
  reversal: "Reversal",
  monochrome: "Black and white",
};

/** Stocks for the camera as a list shows them. */
export function groupedFilms(films: readonly FilmSummary[]): readonly (readonly [string, readonly FilmSummary[]])[] {
  return Object.entries(PROCESS_NAMES).map(([process, label]) => [
    label,
    films.filter((film) => film.kind === "camera" && film.process === process),
  ]);
}

/** A time that a shutter is open, as photographers say it. */
export function formatTime(seconds: number): string {
  if (seconds <= 0) return "a moment";
  if (seconds >= 0.3) return `${Number(seconds.toFixed(seconds < 10 ? 1 : 0)).toString()} s`;
  const parts = 1 / seconds;
  return `1/${Number(parts.toFixed(parts < 10 ? 1 : 0)).toString()} s`;
}

/** The angle of a shutter that a person typed as degrees, or as a time of seconds; null for what is neither. */
export function parseShutter(text: string, framesPerSecond: number): number | null {
  const typed = text.trim().replace(",", ".");
  const asTime = /^(?:([\d.]+)\s*\/\s*)?([\d.]+)\s*s?$/.exec(typed);
  const isTime = typed.includes("/") || typed.endsWith("s");
  if (isTime && asTime) {
    const seconds = asTime[1] === undefined ? Number(asTime[2]) : Number(asTime[1]) / Number(asTime[2]);
    return Number.isFinite(seconds) ? 360 * seconds * framesPerSecond : null;
  }
  const degrees = Number(/^([\d.]+)\s*°?$/.exec(typed)?.[1] ?? NaN);
  return Number.isFinite(degrees) ? degrees : null;
}

const [DIGITS, MINUS] = [1, "−"];

/** Stops with their sign, as a meter says them. */
export function formatStops(stops: number): string {
  const rounded = Number(stops.toFixed(DIGITS)) + 0;
  return `${rounded > 0 ? "+" : rounded < 0 ? MINUS : "±"}${Math.abs(rounded).toString()}`;
}
