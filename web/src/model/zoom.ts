/** Where a picture stands in the room that it has: as a whole, or enlarged about a place of it. */

import { deliveredSize, letterbox } from "./quality";

/** A place in the picture: 0 to 1 from its top left corner. */
type Place = readonly [number, number];

/** Room of the picture, CSS px, and what is to be shown in it. */
export interface Room {
  readonly width: number;
  readonly height: number;
  /** Device pixels for each CSS pixel. */
  readonly ratio: number;
  /** Width over height of the picture. */
  readonly aspect: number;
  /** Width of the delivered picture, px. */
  readonly deliveredPx: number;
}

/** An enlarged picture. */
export interface Placing {
  /** Device pixels for each pixel of the delivered picture, along one side. */
  readonly scale: number;
  /** Place of the picture in the middle of the room. */
  readonly centre: Place;
}

/** CSS px, from the top left corner of the room. */
export interface Box {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
}

/** Largest scale: a pixel is to be seen with its neighbours. */
const MOST = 32;

/** Where the picture stands; null shows it as a whole. Its edges are on device pixels, and what is enlarged covers its room. */
export function placed(room: Room, placing: Placing | null): Box {
  if (placing === null) return snapped(letterbox(room.width, room.height, room.aspect), room.ratio);
  const { width, height } = sizeAt(room, placing.scale);
  const [x, y] = held(room, placing).centre;
  return snapped({ left: room.width / 2 - x * width, top: room.height / 2 - y * height, width, height }, room.ratio);
}

/** Scale at which the picture is shown as a whole. */
export function fitScale(room: Room): number {
  return (letterbox(room.width, room.height, room.aspect).width * room.ratio) / room.deliveredPx;
}

/** A scale about a place, which stays where it is on screen; null where the picture would be smaller than as a whole and than 1:1. */
export function scaledTo(room: Room, placing: Placing | null, scale: number, about: Place): Placing | null {
  const next = Math.min(scale, MOST);
  if (next < Math.min(fitScale(room), 1) * 0.999) return null;
  const [before, after] = [placed(room, placing), sizeAt(room, next)];
  const left = before.left + about[0] * (before.width - after.width);
  const top = before.top + about[1] * (before.height - after.height);
  const centre = [(room.width / 2 - left) / after.width, (room.height / 2 - top) / after.height] as const;
  return held(room, { scale: next, centre });
}

/** The picture moved by so many CSS px. */
export function movedBy(room: Room, placing: Placing, x: number, y: number): Placing {
  const { width, height } = sizeAt(room, placing.scale);
  return held(room, { ...placing, centre: [placing.centre[0] - x / width, placing.centre[1] - y / height] });
}

/** The least that the picture has to move for a place to be in its room. */
export function withPlace(room: Room, placing: Placing, place: Place): Placing {
  const { left, top, width, height } = placed(room, placing);
  const [x, y] = [left + place[0] * width, top + place[1] * height];
  return movedBy(room, placing, Math.min(Math.max(x, 0), room.width) - x, Math.min(Math.max(y, 0), room.height) - y);
}

function sizeAt({ ratio, aspect, deliveredPx }: Room, scale: number): { width: number; height: number } {
  const { width, height } = deliveredSize(deliveredPx, aspect);
  return { width: (width * scale) / ratio, height: (height * scale) / ratio };
}

/** Covers the room with the picture, or centres what is smaller than it. */
function held(room: Room, { scale, centre }: Placing): Placing {
  const { width, height } = sizeAt(room, scale);
  return { scale, centre: [heldAlong(centre[0], room.width / width), heldAlong(centre[1], room.height / height)] };
}

function heldAlong(centre: number, shown: number): number {
  return shown >= 1 ? 0.5 : Math.min(Math.max(centre, shown / 2), 1 - shown / 2);
}

/** Edges on device pixels, so that a picture of that many pixels is shown one to one. */
function snapped({ left, top, width, height }: Box, ratio: number): Box {
  const snap = (value: number): number => Math.round(value * ratio) / ratio;
  const even = (value: number): number => (Math.floor((value * ratio) / 2 + 1e-6) * 2) / ratio;
  return { left: snap(left), top: snap(top), width: even(width), height: even(height) };
}
