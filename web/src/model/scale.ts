/** How a slider's travel stands for a number: positions run from 0 to 1. */

import { LENS_SLIDERS, POINT_SLIDERS, type SliderRange } from "./settings.gen";
import { nearestThird, nextThird } from "./stops";

export interface Scale {
  readonly min: number;
  readonly max: number;
  /** Where a value stands, held within 0 and 1. */
  toPosition(value: number): number;
  /** The value at a position, rounded as people would say it. */
  toValue(position: number): number;
  /** The value one arrow key away. */
  step(value: number, count: number): number;
  /** The same travel without its detents, where it has any. */
  readonly free?: Scale;
}

/** Equal travel for equal ratios, as for focal lengths and stops. */
export function logScale(min: number, max: number, stepRatio: number, round: (value: number) => number): Scale {
  const span = Math.log(max / min);
  const hold = (value: number): number => Math.min(Math.max(value, min), max);
  return {
    min,
    max,
    toPosition: (value) => (value > 0 ? Math.log(hold(value) / min) / span : 0),
    toValue: (position) => hold(round(min * Math.exp(span * Math.min(Math.max(position, 0), 1)))),
    step: (value, count) => {
      const stepped = round(hold(value) * stepRatio ** count);
      return hold(stepped === value ? value + Math.sign(count) * 10 ** (Math.floor(Math.log10(value)) - 2) : stepped);
    },
  };
}

/** A logarithmic scale whose far end is infinity, as on a focus ring. */
export function focusScale(min: number, max: number, stepRatio: number): Scale {
  const travel = 0.97; // the last bit of the ring is infinity
  const inner = logScale(min, max, stepRatio, significant(4));
  return {
    min,
    max: Infinity,
    toPosition: (value) => (value > max ? 1 : inner.toPosition(value) * travel),
    toValue: (position) => (position > travel + (1 - travel) / 2 ? Infinity : inner.toValue(position / travel)),
    step: (value, count) => {
      if (value > max) return count < 0 ? max : Infinity;
      return value >= max && count > 0 ? Infinity : inner.step(value, count);
    },
  };
}

/** Rounds to so many significant digits. */
export function significant(digits: number): (value: number) => number {
  return (value) => Number(value.toPrecision(digits));
}

/** Rounds to a whole multiple. */
export function multipleOf(unit: number): (value: number) => number {
  return (value) => Number((Math.round(value / unit) * unit).toFixed(6));
}

/** Equal travel for equal differences. Values beyond `max` may be typed and stay as they are. */
export function linearScale(min: number, max: number, step: number): Scale {
  const hold = (value: number): number => Math.min(Math.max(value, min), max);
  return {
    min,
    max,
    toPosition: (value) => (hold(value) - min) / (max - min),
    toValue: (position) => multipleOf(step / 5)(min + position * (max - min)),
    step: (value, count) => hold(multipleOf(step)(value + count * step)),
  };
}

/** Focal lengths are in halves of a millimetre up to 100 mm, and in whole ones above. */
function onZoomRing(mm: number): number {
  return multipleOf(mm < 100 ? 0.5 : 1)(mm);
}

/** ISO speeds are in thirds of a stop, and called by the numbers on the dial. */
const ISO_DIAL = [100, 125, 160, 200, 250, 320, 400, 500, 640, 800];
function onIsoDial(iso: number): number {
  const eightfold = 8 ** Math.floor(Math.log(iso / 100) / Math.log(8));
  const near = ISO_DIAL.map((speed) => speed * eightfold);
  return near.reduce((a, b) => (Math.abs(Math.log(b / iso)) < Math.abs(Math.log(a / iso)) ? b : a));
}

/** Travel that is alike for each stop. Its values are thirds of a stop; `free` has those between, too. */
function stopScale(free: Scale): Scale {
  const hold = (stop: number): number => Math.min(Math.max(stop, free.min), free.max);
  return {
    ...free,
    free,
    toValue: (position) => hold(nearestThird(free.toValue(position))),
    step: (stop, count) => (stop > 0 ? hold(nextThird(stop, count) ?? (count > 0 ? free.max : free.min)) : free.min),
  };
}

/** The scale of a slider as a setting declares it. */
export function scaleOf({ least, most, step, scale }: SliderRange): Scale {
  if (scale === "linear") return linearScale(least, most, step);
  if (scale === "ring") return focusScale(least, most, step);
  if (scale === "stop") return stopScale(logScale(least, most, step ** (1 / FREE_STEPS), significant(3)));
  return logScale(least, most, step, ROUNDED[scale]);
}

/** Steps between two detents. */
const FREE_STEPS = 10;

const ROUNDED = { iso: onIsoDial, zoom: onZoomRing } as const;

export const F_NUMBERS = scaleOf(LENS_SLIDERS.fStop.slider);
export const FOCAL_LENGTHS_MM = scaleOf(LENS_SLIDERS.focalLengthMm.slider);
export const FOCUS_DISTANCES_M = scaleOf(LENS_SLIDERS.focusDistanceM.slider);
export const WEIGHTS = scaleOf(POINT_SLIDERS.weight.slider);
