/** The horizontal axis of the timeline. */

import { snapToFrame, type FrameRange } from "../../model/time";
import type { TimeSpan } from "../../model/time_span";

/** The horizontal axis that scrubber, curve and keys share, in CSS px from the left of their box. */
export interface TimeAxis {
  readonly range: FrameRange;
  /** What is shown of it. */
  readonly span: TimeSpan;
  readonly left: number;
  readonly right: number;
  readonly width: number;
  /** px from a frame to the next. */
  readonly perFrame: number;
  readonly x: (time: number) => number;
  /** The frame at a place. */
  readonly time: (x: number) => number;
  /** The time at a place, between frames too. */
  readonly exactTime: (x: number) => number;
  /** Whether a time is shown. */
  readonly has: (time: number) => boolean;
}

const GUTTER_PX = 92;
const MARGIN_PX = 24;

export function timeAxis(range: FrameRange, span: TimeSpan, width: number): TimeAxis {
  const [left, right] = [GUTTER_PX, Math.max(GUTTER_PX + 1, width - MARGIN_PX)];
  const length = span.end - span.start;
  const perFrame = (right - left) / (length > 0 ? length : 1);
  const exactTime = (x: number): number =>
    span.start + (length > 0 ? Math.min(Math.max(x - left, 0), right - left) / perFrame : 0);
  return {
    range,
    span,
    left,
    right,
    width,
    perFrame,
    x: (time) => left + (time - span.start) * perFrame,
    time: (x) => snapToFrame(range, exactTime(x)),
    exactTime,
    has: (time) => time >= span.start - 1e-6 && time <= span.end + 1e-6,
  };
}
