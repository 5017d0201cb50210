/** A service that answers as the test says and remembers what it was asked. */

import type { Command } from "@/model/command";
import type { EditHistory } from "@/model/history";
import type { Quality } from "@/model/quality";
import type { FocusSettings, Readout, Shot } from "@/model/shot";
import { errorOf } from "@/net/errors";
import type { LiveEar, LiveLink, LivePicture, Wish } from "@/net/live";
import type { Service, View } from "@/net/service";

export const SHOT: Shot = {
  id: "demo",
  name: "Demo",
  sizeBytes: 1,
  fileCount: 1,
  range: { start: 1, end: 96, framesPerSecond: 24 },
  cameras: [{ path: "/cam", aspect: 2 }],
  defaultCamera: "/cam",
};

const READOUT: Readout = {
  fStop: 2,
  focalLengthMm: 50,
  focusDistanceM: 3,
  nearM: 2.9,
  farM: 3.1,
  hyperfocalM: 60,
  source: "camera",
  reason: "",
  focusMode: "manual",
  note: "",
  tiltDeg: 0,
  swingDeg: 0,
  lensName: "",
  lensModel: "thin",
};

/** A state of the edits: all that was done to come to it, and the gesture that did the last of it. */
interface State {
  readonly done: readonly Command[];
  readonly gesture: string;
}

export class FakeService implements Partial<Service> {
  /** All that was asked, undone or not. */
  readonly performed: Command[] = [];
  #states: State[] = [{ done: [], gesture: "" }];
  #now = 0;
  readonly frames: { time: number; quality: Quality }[] = [];
  /** What live pictures were wanted, and who waits for them. */
  readonly wishes: Wish[] = [];
  ear: LiveEar | null = null;
  /** How often live pictures were given up. */
  forgotten = 0;
  /** Commands of this kind fail. */
  failing: Command["do"] | null = null;
  /** Called for each command, before it is done; a test may hold it up. */
  gate: () => Promise<void> = () => Promise.resolve();

  /** As the interface that the editor asks; what a test does not need is not there. */
  get service(): Service {
    return this as unknown as Service;
  }

  /** What holds now, of all that was ever asked. */
  get done(): readonly Command[] {
    return this.#states[this.#now]?.done ?? [];
  }

  async perform(_: View, command: Command, __: number, gesture: string): Promise<void> {
    await this.gate();
    if (command.do === this.failing) throw new Error(`no ${command.do}`);
    this.performed.push(command);
    this.#comeTo([...this.done, command], gesture);
  }

  /** Somebody else does something. */
  othersDo(command: Command): void {
    this.#comeTo([...this.done, command], "theirs");
  }

  #comeTo(done: readonly Command[], gesture: string): void {
    const isSame = this.#states[this.#now]?.gesture === gesture;
    const kept = this.#states.slice(0, isSame ? this.#now : this.#now + 1);
    this.#states = JSON.stringify(kept.at(-1)?.done) === JSON.stringify(done) ? kept : [...kept, { done, gesture }];
    this.#now = this.#states.length - 1;
  }

  history(): Promise<EditHistory> {
    const revision = (at: number): string | null => {
      const state = this.#states[at];
      return state ? JSON.stringify(state.done) : null;
    };
    return Promise.resolve({
      revision: revision(this.#now) ?? "",
      before: revision(this.#now - 1),
      after: revision(this.#now + 1),
      undo: "what the service calls it",
      redo: "what the service calls it",
    });
  }

  async undo(_: string, revision: string): Promise<EditHistory> {
    return this.#walk(-1, revision);
  }

  async redo(_: string, revision: string): Promise<EditHistory> {
    return this.#walk(1, revision);
  }

  async #walk(by: number, revision: string): Promise<EditHistory> {
    if ((await this.history()).revision !== revision) throw errorOf(412, { code: "changed_meanwhile", detail: "No." });
    this.#now += by;
    return this.history();
  }

  async restore(_: string, to: string, now: string, gesture: string): Promise<void> {
    if ((await this.history()).revision !== now) throw errorOf(412, { code: "changed_meanwhile", detail: "No." });
    this.#comeTo(JSON.parse(to) as Command[], gesture);
  }

  forget(): void {
    // It keeps no tags.
  }

  live(_: View, ear: LiveEar): LiveLink {
    this.ear = ear;
    return {
      free: true,
      want: (wish) => void this.wishes.push(wish),
      forget: () => (this.forgotten += 1),
      close: () => (this.ear = null),
    };
  }

  /** A picture for the newest wish comes, or for the one at an index. */
  async show(stage: LivePicture["stage"], index = -1): Promise<void> {
    const wish = this.wishes.at(index);
    if (!wish || !this.ear) throw new Error("Nobody waits for a picture.");
    const scale = stage === "preview" ? 0.25 : 1;
    const { width, height, rays } = wish.quality;
    const said = { width: width * scale, height: height * scale, rays, share: Number(stage === "final"), tookMs: 80 };
    await this.ear.onPicture({ blob: new Blob([stage]), stage, ...said }, wish);
  }

  async frame(_: View, time: number, quality: Quality): Promise<Blob> {
    this.frames.push({ time, quality });
    await new Promise((resolve) => setTimeout(resolve, 150));
    return new Blob(["picture"]);
  }

  focusSettings(): Promise<FocusSettings> {
    return Promise.resolve({ keys: {} } as unknown as FocusSettings);
  }

  focusPoints(): Promise<[]> {
    return Promise.resolve([]);
  }

  readout(): Promise<Readout> {
    return Promise.resolve(READOUT);
  }
}

/** Lets everything that waits for nothing but its turn happen. */
export async function turn(): Promise<void> {
  await new Promise((resolve) => setTimeout(resolve));
}
