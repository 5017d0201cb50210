/** Renders and their frames for tests, and a service that records what it is asked for. */

import type { Render, RenderAction, RenderPage, RenderPlan, RenderRequest, RenderTask } from "@/model/renders";
import type { FrameLogText, RenderService } from "@/net/renders";

const RENDER: Render = {
  id: "r-1",
  name: "dailies",
  shot: "demo",
  revision: "5a302e56",
  project: "default",
  owner: "Mara",
  state: "queued",
  priority: 50,
  frames: "1-4",
  width: 480,
  rays: 16,
  formats: ["png"],
  aovs: [],
  lens: null,
  products: [],
  count: 4,
  ready: 4,
  running: 0,
  done: 0,
  failed: 0,
  canceled: 0,
  accepted: false,
  waitsFor: [],
  createdAt: "2026-11-27T08:00:00Z",
  startedAt: null,
  finishedAt: null,
  secondsLeft: null,
};

export function render(change: Partial<Render> = {}): Render {
  return { ...RENDER, ...change };
}

/** A frame that ended after so many seconds, or has not ended. */
export function task(frame: number, state: RenderTask["state"], afterS = 0, error: string | null = null): RenderTask {
  const isStored = state === "done";
  const outcome = isStored ? "done" : "failed";
  const startedAt = "2026-11-27T08:00:00Z";
  const endedAt = new Date(Date.parse(startedAt) + 1000 * afterS).toISOString();
  const attempt = { number: 1, worker: "pc", startedAt, endedAt, outcome, error } as const;
  const attempts = isStored || state === "failed" ? [attempt] : [];
  const files = isStored ? [{ format: "png", sizeBytes: 1000, sha256: `hash ${frame}` } as const] : [];
  return { frame, state, files, attempts };
}

export class FakeRenders implements RenderService {
  all: readonly Render[] = [];
  ofRender: readonly RenderTask[] = [];
  /** What was asked for, in order. */
  readonly calls: string[] = [];
  readonly sent: { request: RenderRequest; key: string }[] = [];
  readonly planned: RenderRequest[] = [];
  /** What stands against a render that is tried. */
  findings: NonNullable<RenderPlan["findings"]> = [];
  /** The log of each frame, as it is at each look. */
  readonly logs: FrameLogText[] = [];
  /** Fails the next call of a kind with an error. */
  failing: Partial<Record<"list" | "plan" | "send" | "act" | "log", unknown>> = {};
  /** Holds up the next lists. */
  gate: () => Promise<void> = () => Promise.resolve();

  async list(most: number, before: string | null): Promise<RenderPage> {
    this.calls.push(`list ${most} ${before ?? "newest"}`);
    this.#failAt("list");
    const all = this.all;
    await this.gate();
    const start = all.findIndex(({ id }) => id === before) + 1;
    const renders = all.slice(start, start + most);
    return { renders, next: start + most < all.length ? (renders.at(-1)?.id ?? null) : null };
  }

  async plan(request: RenderRequest): Promise<RenderPlan> {
    await Promise.resolve();
    this.planned.push(request);
    this.#failAt("plan");
    return {
      frames: request.frames ?? "1-96",
      count: 96,
      secondsOfProcessor: 310,
      settings: null,
      findings: this.findings,
    };
  }

  async send(request: RenderRequest, key: string): Promise<Render> {
    await Promise.resolve();
    this.sent.push({ request, key });
    this.#failAt("send");
    return render({ id: `r-${key}` });
  }

  async act(id: string, action: RenderAction): Promise<Render | null> {
    await Promise.resolve();
    this.calls.push(`${action} ${id}`);
    this.#failAt("act");
    const changed = action === "remove" ? [] : [render({ id, state: "paused" })];
    this.all = this.all.flatMap((each) => (each.id === id ? changed : [each]));
    return changed[0] ?? null;
  }

  tasks(id: string): Promise<readonly RenderTask[]> {
    this.calls.push(`tasks ${id}`);
    return Promise.resolve(this.ofRender);
  }

  async log(id: string, frame: number, attempt: number): Promise<FrameLogText> {
    await Promise.resolve();
    this.calls.push(`log ${id} ${frame} ${attempt}`);
    this.#failAt("log");
    return this.logs.shift() ?? { text: "", hasEnded: true };
  }

  frameAddress(id: string, frame: number, format: string): string {
    return `${id}/${frame}.${format}`;
  }

  thumbnailAddress(id: string, frame: number): string {
    return `${id}/${frame}/thumbnail`;
  }

  changes(): EventSource {
    throw new Error("tests give their own changes");
  }

  productAddress(id: string, product: string): string {
    return `${id}/${product}`;
  }

  reportAddress(id: string, format: string): string {
    return `${id}/focus-report.${format}`;
  }

  #failAt(kind: keyof FakeRenders["failing"]): void {
    const error = this.failing[kind];
    this.failing = { ...this.failing, [kind]: undefined };
    // eslint-disable-next-line @typescript-eslint/only-throw-error -- the service's errors are what the test gives
    if (error !== undefined) throw error;
  }
}
