/** A session whose one focus point has keys, for tests of what is done with them. */

import { signal } from "@preact/signals";
import { Session } from "@/editor/session";
import type { KeyStack } from "@/model/key_lanes";
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

/** Gives the point other keys, as the service has them after an edit. */
export function nowAt(fake: FakeService, ...times: number[]): void {
  const points = [point("pip", { weight: Object.fromEntries(times.map((time) => [time, 1])) })];
  fake.points = points;
  fake.state = { points, readout: null, focusSettings: null, photography: null, curve: null };
}
