/** A render that is typed: tried at the service while it is, and sent once. */

import { computed, signal, type Signal } from "@preact/signals";
import { chosenAovs } from "../model/aovs";
import { chosenProducts, wordsOf } from "../model/deliverables";
import { faultsIn, fieldOf, framesOf, requestOf, type DraftFault, type RenderDraft } from "../model/render_draft";
import type { Render, RenderPlan, RenderRequest } from "../model/renders";
import { restQuality } from "../model/quality";
import { complaintOf, isAbort, sentence, ServiceError } from "../net/errors";
import type { RenderService } from "../net/renders";
import type { Session } from "./session";

/** Rest before a draft is tried, ms. */
const PAUSE_MS = 300;

/** What is rendered. */
export type RenderSource = Pick<Session, "shot" | "camera" | "aspect" | "idle"> & {
  readonly document: { readonly revision: { peek(): number } };
  readonly motion: { peek(): number };
  readonly playhead: {
    readonly played: { peek(): Session["shot"]["range"] };
    readonly time: { peek(): number };
  };
};

/** What of the render that was sent last is remembered, each as words between commas. */
export interface RememberedRender {
  readonly aovs: Signal<string>;
  /** What was made. */
  readonly delivered: Signal<string>;
}

/** Frames that are chosen at once. */
export type QuickFrames = "this" | "range" | "whole";

export class RenderForm {
  readonly draft;
  /** What the draft would be; null where that is not known. */
  readonly plan = signal<RenderPlan | null>(null);
  readonly faults = computed(() => [...faultsIn(this.draft.value), ...this.#refused.value]);
  readonly isSending = signal(false);
  /** Whether the service is checking the draft. */
  readonly isTrying = signal(false);

  readonly #service: RenderService;
  readonly #source: RenderSource;
  readonly #remembered: RememberedRender;
  /** What the service has found in the draft. */
  readonly #refused = signal<readonly DraftFault[]>([]);
  #timer: ReturnType<typeof setTimeout> | undefined;
  #trying = new AbortController();
  /** What the service has found nothing against. */
  #accepted = "";
  /** What was sent last, and its key: the same once more is the same render. */
  #sent = { what: "", key: "" };

  /**
   * @param width of delivered pictures, px.
   * @param remembered of the render that was sent last; written when one is sent.
   */
  constructor(service: RenderService, source: RenderSource, width: string, remembered: RememberedRender) {
    [this.#service, this.#source, this.#remembered] = [service, source, remembered];
    this.draft = signal<RenderDraft>({
      name: "",
      frames: framesOf(source.playhead.played.peek()),
      width,
      rays: "100",
      priority: "50",
      ...chosenProducts(remembered.delivered.peek()),
      ...chosenAovs(remembered.aovs.peek()),
      after: [],
    });
    void this.#try();
  }

  get shotName(): string {
    return this.#source.shot.name;
  }

  type(change: Partial<RenderDraft>): void {
    this.draft.value = { ...this.draft.peek(), ...change };
    this.#refused.value = [];
    this.#stop();
    this.#timer = setTimeout(() => void this.#try(), PAUSE_MS);
  }

  /** Frames of a quick choice, as they would be typed. */
  framesOf(quick: QuickFrames): string {
    const { shot, playhead } = this.#source;
    const [range, now] = [shot.range, playhead.time.peek()];
    if (quick === "this") return framesOf({ ...range, start: Math.round(now), end: Math.round(now) });
    return framesOf(quick === "range" ? playhead.played.peek() : range);
  }

  /** Sends the render as the shot is once all edits are made; null where it was refused, or is being sent. */
  async send(): Promise<Render | null> {
    if (this.isSending.peek() || faultsIn(this.draft.peek()).length > 0) return null;
    this.isSending.value = true;
    this.#stop();
    try {
      await this.#source.idle();
      const request = this.#request();
      if (this.#accepted !== this.#whatOf(request) && !(await this.#isAccepted(request))) return null;
      const render = await this.#service.send(request, this.#keyOf(request));
      if (request.formats?.includes("exr")) this.#remembered.aovs.value = (request.aovs ?? []).join(",");
      this.#remembered.delivered.value = wordsOf(this.draft.peek());
      return render;
    } catch (error) {
      this.#refuse(error);
      return null;
    } finally {
      this.isSending.value = false;
    }
  }

  close(): void {
    this.#stop();
  }

  /** Has the service check the draft. */
  async #try(): Promise<void> {
    if (faultsIn(this.draft.peek()).length > 0) {
      this.plan.value = null;
      return;
    }
    const trying = (this.#trying = new AbortController());
    this.isTrying.value = true;
    try {
      await this.#isAccepted(this.#request(), trying.signal);
    } catch (error) {
      if (!trying.signal.aborted) this.#refuse(error);
    } finally {
      if (!trying.signal.aborted) this.isTrying.value = false;
    }
  }

  /** Whether the service finds nothing that stands against a request. */
  async #isAccepted(request: RenderRequest, signal?: AbortSignal): Promise<boolean> {
    const what = this.#whatOf(request);
    const plan = await this.#service.plan(request, signal);
    if (signal?.aborted === true) return false;
    this.#refused.value = faultsInPlan(plan);
    const isAccepted = this.#refused.peek().length === 0;
    this.plan.value = isAccepted ? plan : null;
    if (isAccepted) this.#accepted = what;
    return isAccepted;
  }

  #stop(): void {
    clearTimeout(this.#timer);
    this.#trying.abort();
    this.isTrying.value = false;
  }

  #refuse(error: unknown): void {
    if (isAbort(error)) return;
    this.plan.value = null;
    this.#refused.value = faultsOf(error);
  }

  #request(): RenderRequest {
    const { shot, camera, aspect, motion } = this.#source;
    const draft = this.draft.peek();
    const width = Number(draft.width);
    return requestOf(draft, { ...restQuality(width, width / aspect, motion.peek()), shot: shot.id, camera });
  }

  /** A request, and the edits that it would be of. */
  #whatOf(request: RenderRequest): string {
    return `${this.#source.document.revision.peek()} ${JSON.stringify(request)}`;
  }

  /** A key for each render: another one for another request, and for other edits. */
  #keyOf(request: RenderRequest): string {
    const what = this.#whatOf(request);
    if (what !== this.#sent.what) this.#sent = { what, key: randomKey() };
    return this.#sent.key;
  }
}

/** Browsers have `randomUUID` on https alone. */
function randomKey(): string {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** What stands against a render that was tried, each at the field that it is about. */
function faultsInPlan({ findings = [] }: RenderPlan): readonly DraftFault[] {
  const errors = findings.filter(({ severity }) => severity === "error");
  return errors.map(({ path, message }) => ({ field: fieldOf(path), message: sentence(message) }));
}

/** What the service has found, each at the field that it is about. */
export function faultsOf(error: unknown): readonly DraftFault[] {
  if (error instanceof ServiceError) {
    const findings = error.findings.length > 0 ? error.findings : [{ path: error.path, detail: error.message }];
    const faults = findings.map(({ path, detail }) => ({ field: fieldOf(path), message: sentence(detail) }));
    if (faults.some(({ field }) => field !== null)) return faults;
  }
  const { message, advice } = complaintOf(error);
  return [{ field: null, message: `${message} ${advice}`.trim() }];
}
