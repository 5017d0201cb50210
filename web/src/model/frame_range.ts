/** Ranges of frames as text, in the grammar of Open Job Description, as service/jobs/frame_ranges.py reads them. */

const MOST_FRAMES = 10_000;
const MOST_FRAME = 1e9;
const PART = /^\s*(-?[0-9]{1,10})\s*(?:-\s*(-?[0-9]{1,10})\s*(?::\s*(-?[0-9]{1,10})\s*)?)?$/;

/** What is wrong with a range; null where it names frames. */
export function faultOfFrames(text: string): string | null {
  const frames = new Set<number>();
  for (const part of text.split(",")) {
    const range = rangeOf(part);
    if (typeof range === "string") return range;
    const [first, last, step] = range;
    const count = Math.floor((last - first) / step) + 1;
    if (frames.size + count > MOST_FRAMES) return `A render has ${MOST_FRAMES.toLocaleString("en")} frames at most.`;
    for (let frame = first; step > 0 ? frame <= last : frame >= last; frame += step) {
      if (frames.has(frame)) return `Frame ${frame} comes twice.`;
      frames.add(frame);
    }
  }
  return null;
}

/** First and last frame and step of a part, or what is wrong with it. */
function rangeOf(part: string): readonly [number, number, number] | string {
  const found = PART.exec(part);
  if (!found) return "Type frames such as 1-10:2,15.";
  const first = Number(found[1]);
  const last = Number(found[2] ?? found[1]);
  const step = Number(found[3] ?? 1);
  if (Math.max(Math.abs(first), Math.abs(last)) > MOST_FRAME) {
    return `Frames lie between -${MOST_FRAME.toLocaleString("en")} and ${MOST_FRAME.toLocaleString("en")}.`;
  }
  if (step === 0 || (last - first) * step < 0) {
    return `The step of '${part.trim()}' does not lead from its first frame to its last.`;
  }
  return [first, last, step];
}
