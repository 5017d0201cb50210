/** A session whose one focus point has keys, for tests of what is done with them. */

import { signal } from "@preact/signals";
import { Session } from "@/editor/session";
import type { Changes } from "@/model/changes";
import type { KeyStack } from "@/model/key_lanes";
import type { Key } from "@/model/keys";
import type { FocusPoint } from "@/model/shot";
import { sameTime } from "@/model/time";
import { FakeService, SHOT, turn } from "./fake_service";
import { point } from "./points";

export interface Opened {
  readonly fake: FakeService;
  readonly session: Session;
  readonly failed: unknown[];
}

/** A session whose point has keys of its weight at frames 1, 10 and 20. */
export async function opened(): Promise<Opened> {
  const fake = new FakeService();
  const failed: unknown[] = [];
  fake.points = [point("pip", { weight: { 1: 1, 10: 0, 20: 1 } })];
  keepKeys(fake);
  const rights = { noEdits: signal(null), noPictures: signal(null) };
  const session = new Session(fake.service, SHOT, "/cam", 1, (error) => failed.push(error), rights);
  await turn();
  return { fake, session, failed };
}

export function stackAt({ keys }: Session, time: number): KeyStack {
  const found = keys.lanes.value.flatMap(({ stacks }) => stacks).find((stack) => stack.time === time);
  if (!found) throw new Error(`There is no key at ${time.toString()}.`);
  return found;
}

/** Lets edits change the keys of the points, and an undo take that back. */
function keepKeys(fake: FakeService): void {
  const before: FocusPoint[][] = [];
  const undo = fake.undo.bind(fake);
  const set = (points: FocusPoint[]): void => {
    fake.points = points;
    if (fake.state) fake.state = { ...fake.state, points };
  };
  fake.onMade = (changes) => {
    before.push(fake.points);
    set(keyed(fake.points, changes));
  };
  fake.undo = async (...of) => {
    const history = await undo(...of);
    set(before.pop() ?? fake.points);
    return history;
  };
}

/** Points with the keys that changes leave them. */
function keyed(points: readonly FocusPoint[], changes: Changes): FocusPoint[] {
  return points.map((before) => {
    const keys = { ...before.keys };
    for (const change of changes) {
      const isKey = change.type === "keyPoint" || change.type === "unkeyPoint";
      if (!isKey || change.name !== before.name) continue;
      const time = change.type === "keyPoint" ? change.key.time : change.time;
      const others = (keys[change.attribute] ?? []).filter((key) => !sameTime(key.time, time));
      const set = change.type === "keyPoint" ? [change.key as Key] : [];
      keys[change.attribute] = [...others, ...set].toSorted((a, b) => a.time - b.time);
    }
    return { ...before, keys };
  });
}

/** Gives the point other keys, as the service has them after an edit. */
export function nowAt(fake: FakeService, ...times: number[]): void {
  const points = [point("pip", { weight: Object.fromEntries(times.map((time) => [time, 1])) })];
  fake.points = points;
  fake.state = { points, readout: null, focusSettings: null, photography: null, curve: null };
}
