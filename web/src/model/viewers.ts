/** Others who look at the same shot, as they are told apart: by name, initials and a colour. */

import type { components } from "../net/schema";
import { POINT_COLORS, type PointColor } from "./shot";
import { sameTime } from "./time";

export type Viewers = components["schemas"]["LiveViewers"];
type Viewer = Viewers["viewers"][number];

/** Name of senders on a service that does not know them by name. */
const ANYONE = "anyone";
const COLOURS = POINT_COLORS.filter((colour) => colour !== "none");

/** Somebody else who looks at the shot. */
export interface Other {
  /** Of the connection; a person may have several. */
  readonly id: string;
  readonly label: string;
  readonly initials: string;
  /** One for each person, as long as there are no more people than colours. */
  readonly colour: PointColor;
  /** Prim path of the camera; null for the default camera. */
  readonly camera: string | null;
  /** Time of the frame; null before a picture was asked for. */
  readonly time: number | null;
}

/** The others, in the order in which they came. */
export function othersOf({ you, viewers }: Viewers): readonly Other[] {
  return viewers.filter(({ id }) => id !== you).map((viewer) => otherOf(viewer, viewers));
}

function otherOf(viewer: Viewer, all: readonly Viewer[]): Other {
  const { id, name, number, camera, time } = viewer;
  if (name === ANYONE) {
    const [label, initials] = [`Guest ${number}`, `G${number}`];
    return { id, label, initials, colour: colourOf(number), camera, time };
  }
  const ownNumbers = all.filter((one) => one.name === name).map((one) => one.number);
  const earlier = ownNumbers.filter((one) => one < number).length;
  const label = earlier === 0 ? name : `${name} (${earlier + 1})`;
  return { id, label, initials: initialsOf(name), colour: colourOf(Math.min(...ownNumbers)), camera, time };
}

function colourOf(number: number): PointColor {
  return COLOURS[(number - 1) % COLOURS.length] ?? "none";
}

/** First letters of the first and the last word of a name; of a single word the first two. */
function initialsOf(name: string): string {
  const words = name.split(/[^\p{L}\p{N}]+/u).filter(Boolean);
  const [first = "?", last] = [words[0], words.length > 1 ? words.at(-1) : undefined];
  const [one = "", two = ""] = Array.from(first);
  return last === undefined ? one.toUpperCase() + two : (one + (Array.from(last)[0] ?? "")).toUpperCase();
}

/** The frame that others are at, and who they are. */
export interface Gathering {
  readonly time: number;
  readonly others: readonly Other[];
}

/** The others by their frames. */
export function byFrame(others: readonly Other[]): readonly Gathering[] {
  const found = new Map<number, Other[]>();
  for (const other of others) {
    if (other.time === null) continue;
    const there = [...found.keys()].find((time) => sameTime(time, other.time ?? time)) ?? other.time;
    found.set(there, [...(found.get(there) ?? []), other]);
  }
  return [...found].map(([time, here]) => ({ time, others: here }));
}

/**
 * Who is next to be gone to: whoever is at the place after that of a frame and camera, where somebody is there already, else the
 * first; null for nobody. Of those at one place the first counts.
 */
export function nextOther(others: readonly Other[], time: number, camera: string | null): Other | null {
  const placeOf = (other: Other): string => `${other.time ?? ""} ${other.camera ?? camera ?? ""}`;
  const placed = others.filter((other) => other.time !== null);
  const isFirst = (other: Other): boolean => placed.find((one) => placeOf(one) === placeOf(other)) === other;
  const places = placed.filter(isFirst);
  // The playhead goes to whole frames.
  const isHere = (other: Other): boolean =>
    Math.abs((other.time ?? Infinity) - time) <= 0.5 && (other.camera ?? camera) === camera;
  const at = places.findIndex(isHere);
  return places[(at + 1) % places.length] ?? null;
}
