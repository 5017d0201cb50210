/** A service that answers as the test says and remembers what it was asked. */

import type { Command } from "@/model/command";
import type { Quality } from "@/model/quality";
import type { Readout, Shot } from "@/model/shot";
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
  lensName: "",
  lensModel: "thin",
};

export class FakeService implements Partial<Service> {
  readonly performed: Command[] = [];
  readonly frames: { time: number; quality: Quality }[] = [];
  /** Commands of this kind fail. */
  failing: Command["do"] | null = null;
  /** Called for each command, before it is done; a test may hold it up. */
  gate: () => Promise<void> = () => Promise.resolve();

  /** As the interface that the editor asks; what a test does not need is not there. */
  get service(): Service {
    return this as unknown as Service;
  }

  async perform(_: View, command: Command): Promise<void> {
    await this.gate();
    if (command.do === this.failing) throw new Error(`no ${command.do}`);
    this.performed.push(command);
  }

  /** Takes as long as neither makes the page ask for less nor for more. */
  async frame(_: View, time: number, quality: Quality): Promise<Blob> {
    this.frames.push({ time, quality });
    await new Promise((resolve) => setTimeout(resolve, 150));
    return new Blob(["picture"]);
  }

  focusPoints(): Promise<[]> {
    return Promise.resolve([]);
  }

  /** How many commands there were: another one after every edit. */
  revision(): Promise<string> {
    return Promise.resolve(this.performed.length.toString());
  }

  readout(): Promise<Readout> {
    return Promise.resolve(READOUT);
  }
}

/** Lets everything that waits for nothing but its turn happen. */
export async function turn(): Promise<void> {
  await new Promise((resolve) => setTimeout(resolve));
}
