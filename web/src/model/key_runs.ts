/** Runs of keys that stand so close that a pointer cannot tell them apart. */

import { CAMERA_PLACE, laneOf, type KeyLane, type KeyStack } from "./key_lanes";

/** Whether a lane has the keys of the camera's place. */
export function isOfPlace({ id }: KeyLane): boolean {
  return id === laneOf(CAMERA_PLACE);
}

/** Stacks, in the order of time, by runs of those that are closer to each other than so many frames. */
export function runsOf(stacks: readonly KeyStack[], room: number): KeyStack[][] {
  const runs: KeyStack[][] = [];
  for (const stack of stacks) {
    const run = runs.at(-1);
    const last = run?.at(-1);
    if (run && last && stack.time - last.time < room) run.push(stack);
    else runs.push([stack]);
  }
  return runs;
}

/** The stack that is nearest to a time; of one at least. */
export function nearestOf(stacks: readonly KeyStack[], time: number): KeyStack {
  return stacks.reduce((best, each) => (Math.abs(each.time - time) < Math.abs(best.time - time) ? each : best));
}
