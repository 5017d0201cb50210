/** Facts about a picture in its corners, as deliveries burn them in: the words of `render.output.burn_in`. */

import { formatDistance, type LengthUnit } from "./distance";
import { statedStop, type Marking } from "./stops";
import { formatFrame } from "./time";

/** In the order in which they are listed. */
export const FACTS = [
  "shot",
  "camera",
  "lens",
  "focal",
  "stop",
  "focus",
  "film",
  "revision",
  "date",
  "frame",
  "timecode",
] as const;
export type Fact = (typeof FACTS)[number];

/** Those that are chosen before anybody has chosen. */
export const STANDARD_FACTS: readonly Fact[] = [
  "shot",
  "camera",
  "lens",
  "focal",
  "stop",
  "focus",
  "frame",
  "timecode",
];

export type Corner = "top-left" | "top-right" | "bottom-left" | "bottom-right";

/** Lines of each corner; facts of one line stand side by side. */
const LINES: Readonly<Record<Corner, readonly (readonly Fact[])[]>> = {
  "top-left": [["shot"], ["camera"]],
  "top-right": [["lens"], ["focal", "stop", "focus"]],
  "bottom-left": [["film"], ["revision", "date"]],
  "bottom-right": [["frame", "timecode"]],
};
const SEPARATOR = " · ";
/** Digits of a revision that tell it from others of a shot. */
const REVISION_DIGITS = 8;

/** What a picture was taken with; null where there is no lens. */
export interface TakenWith {
  readonly lensName: string;
  readonly lensModel: string;
  readonly focalLengthMm: number;
  /** Number on the barrel; 0 is a pinhole. */
  readonly stop: number;
  readonly marking: Marking;
  readonly transmittance: number;
  readonly focusDistanceM: number;
}

export interface Filmed {
  readonly shot: string;
  readonly camera: string;
  readonly time: number;
  readonly framesPerSecond: number;
  readonly lens: TakenWith | null;
  /** Empty for no film. */
  readonly film: string;
  /** Of the shot's edits; may be empty. */
  readonly revision: string;
  readonly date: Date;
}

/** The chosen facts in words, by corner; corners without any are left out. */
export function burnIn(
  chosen: readonly string[],
  filmed: Filmed,
  unit: LengthUnit,
): readonly { readonly corner: Corner; readonly lines: readonly string[] }[] {
  const said = factsOf(filmed, unit);
  const corners = Object.entries(LINES) as [Corner, (typeof LINES)[Corner]][];
  return corners
    .map(([corner, lines]) => ({
      corner,
      lines: lines
        .map((facts) =>
          facts
            .filter((fact) => chosen.includes(fact))
            .map((fact) => said[fact])
            .filter(Boolean)
            .join(SEPARATOR),
        )
        .filter(Boolean),
    }))
    .filter(({ lines }) => lines.length > 0);
}

function factsOf(filmed: Filmed, unit: LengthUnit): Readonly<Record<Fact, string>> {
  const { shot, camera, time, framesPerSecond, lens, film, revision, date } = filmed;
  return {
    shot,
    camera,
    lens: lens ? lensWords(lens) : "",
    focal: lens ? `${Number(lens.focalLengthMm.toFixed(1)).toString()} mm` : "",
    stop: lens ? statedStop(lens.stop, lens.marking, lens.transmittance) : "",
    focus: lens ? `focus ${formatDistance(lens.focusDistanceM, unit)}` : "",
    film,
    revision: revision && `rev ${revision.slice(0, REVISION_DIGITS)}`,
    date: dayOf(date),
    frame: `frame ${formatFrame(time)}`,
    timecode: timeCode(time, framesPerSecond),
  };
}

function lensWords({ lensName, lensModel }: TakenWith): string {
  return lensName || `${lensModel} lens`;
}

/** A day as year, month and day. */
function dayOf(date: Date): string {
  const two = (value: number): string => value.toString().padStart(2, "0");
  return `${date.getFullYear()}-${two(date.getMonth() + 1)}-${two(date.getDate())}`;
}

/** The time code of a time, without drop frames; empty before 0 and from a day on, where there is none. */
export function timeCode(time: number, framesPerSecond: number): string {
  const rate = Math.max(1, Math.round(framesPerSecond));
  const frame = Math.floor(time + 1e-6);
  const seconds = Math.floor(frame / rate);
  if (!(frame >= 0 && seconds < 24 * 3600)) return "";
  const parts = [Math.floor(seconds / 3600), Math.floor(seconds / 60) % 60, seconds % 60, frame % rate];
  return parts.map((part) => part.toString().padStart(2, "0")).join(":");
}
