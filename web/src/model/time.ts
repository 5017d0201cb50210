/** Time on the page. A time is a USD time code, and from one frame of the shot to the next it goes up by 1. */

export interface FrameRange {
  /** First time code. */
  readonly start: number;
  /** Last time code, included. */
  readonly end: number;
  /** Frames in one second of the shot. */
  readonly framesPerSecond: number;
}

/** Number of frames of the range, both ends included; at least 1. */
export function frameCount(range: FrameRange): number {
  return Math.max(1, Math.floor(range.end - range.start + 1e-6) + 1);
}

/** The time code of the frame that is nearest to `time`, within the range. */
export function snapToFrame(range: FrameRange, time: number): number {
  return range.start + Math.min(Math.max(Math.round(time - range.start), 0), frameCount(range) - 1);
}

/** The frame `count` steps away, held at the ends of the range. */
export function stepFrames(range: FrameRange, time: number, count: number): number {
  return snapToFrame(range, snapToFrame(range, time) + count);
}

/** Where a time stands in the range: 0 at the first frame, 1 at the last. */
export function fractionOf(range: FrameRange, time: number): number {
  return range.end > range.start ? (time - range.start) / (range.end - range.start) : 0;
}

/** The frame at a fraction of the range. */
export function frameAtFraction(range: FrameRange, fraction: number): number {
  return snapToFrame(range, range.start + fraction * (range.end - range.start));
}

/** Whether two times are the same frame for all that a person can see. */
export function sameTime(a: number, b: number): boolean {
  return Math.abs(a - b) < 1e-4;
}

/** The nearest of some times, the first of equal ones; null where there is none. */
export function nearestTime(times: readonly number[], time: number): number | null {
  return times.reduce<number | null>(
    (best, t) => (best === null || Math.abs(t - time) < Math.abs(best - time) ? t : best),
    null,
  );
}

/** A frame number as people write it: whole where it is whole. */
export function formatFrame(time: number): string {
  return Number.isInteger(time) ? time.toString() : time.toFixed(2);
}

/** Frame labels for an axis: a round step that leaves at most `most` of them, and the frames on it. */
export function frameTicks(range: FrameRange, most: number): number[] {
  const span = range.end - range.start;
  if (span <= 0) return [range.start];
  const rough = span / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = Math.max(1, ([1, 2, 5, 10].find((m) => m * power >= rough) ?? 10) * power);
  const ticks: number[] = [];
  for (let time = Math.ceil(range.start / step) * step; time <= range.end + 1e-6; time += step) ticks.push(time);
  return ticks;
}
