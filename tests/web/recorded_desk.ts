/** A desk whose shot plays by a clock that the test turns. */

import { signal } from "@preact/signals";
import type { Fail } from "@/editor/fail";
import { KeptPulls } from "@/editor/kept_pulls";
import { usualDesk, type RingDesk } from "@/editor/ring_desk";
import { Session } from "@/editor/session";
import { FakeService, SHOT, turn } from "./fake_service";

let now = 0;
let frames = new Map<number, FrameRequestCallback>();
let count = 0;

/** Goes on by frames of the screen, 60 a second, in which something is done. */
export function pass(seconds: number, each: () => void = () => undefined): void {
  for (let at = 0; at < Math.round(60 * seconds); at += 1) {
    now += 1000 / 60;
    each();
    const due = frames;
    frames = new Map();
    for (const act of due.values()) act(now);
  }
}

export class Store {
  kept: string | null = null;
  isFull = false;
  getItem(): string | null {
    return this.kept;
  }
  setItem(_key: string, value: string): void {
    if (this.isFull) throw new Error("It is full.");
    this.kept = value;
  }
}

/** Lets the tests of a file turn the clock. */
export function turnsClock(): void {
  beforeEach(() => {
    now = 0;
    frames = new Map();
    vi.spyOn(performance, "now").mockImplementation(() => now);
    vi.stubGlobal("requestAnimationFrame", (act: FrameRequestCallback) => {
      count += 1;
      frames.set(count, act);
      return count;
    });
    vi.stubGlobal("cancelAnimationFrame", (request: number) => frames.delete(request));
  });

  afterEach(() => {
    vi.restoreAllMocks();
    vi.unstubAllGlobals();
  });
}

/** Lets time pass in which the screen shows nothing. */
export function wait(ms: number): void {
  now += ms;
}

export async function opened(
  store = new Store(),
  fail: Fail = () => undefined,
): Promise<{ fake: FakeService; session: Session; desk: RingDesk }> {
  const fake = new FakeService();
  const rights = { noEdits: signal(null), noPictures: signal(null) };
  const args = [fake.service, SHOT, "/cam", 1, fail, rights] as const;
  const choices = { ...usualDesk(), kept: new KeptPulls(store, "me") };
  const session = new Session(...args, undefined, undefined, choices);
  await read();
  return { fake, session, desk: session.desk };
}

/** Lets the lens be read, which waits for frames of the screen. */
export async function read(): Promise<void> {
  for (let step = 0; step < 6; step += 1) {
    await turn();
    pass(1 / 60);
  }
}
