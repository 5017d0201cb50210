/** The horizontal axis of the timeline. */

import { fractionOf, frameAtFraction, type FrameRange } from "../../model/time";

/** The horizontal axis that scrubber, curve and keys share, in CSS px from the left of their box. */
export interface TimeAxis {
  readonly range: FrameRange;
  readonly left: number;
  readonly right: number;
  readonly width: number;
  /** px from a frame to the next. */
  readonly perFrame: number;
  readonly x: (time: number) => number;
  readonly time: (x: number) => number;
}

const GUTTER_PX = 92;
const MARGIN_PX = 24;

export function timeAxis(range: FrameRange, width: number): TimeAxis {
  const [left, right] = [GUTTER_PX, Math.max(GUTTER_PX + 1, width - MARGIN_PX)];
  return {
    range,
    left,
    right,
    width,
    perFrame: (right - left) / Math.max(1, range.end - range.start),
    x: (time) => left + fractionOf(range, time) * (right - left),
    time: (x) => frameAtFraction(range, Math.min(Math.max((x - left) / (right - left), 0), 1)),
  };
}
