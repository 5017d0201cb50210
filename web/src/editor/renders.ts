/** The renders of the project as they go on, and the frames of the one that is looked at. */

import { computed, signal } from "@preact/signals";
import type { Render, RenderAction, RenderTask } from "../model/renders";
import { complaintOf, isAbort } from "../net/errors";
import type { RenderChanges } from "../net/render_changes";
import type { RenderService } from "../net/renders";

/** Renders that are listed at first, and more each time. */
const SHOWN = 50;
/** Most renders in an answer of the service. */
const MOST_IN_PAGE = 200;

export class Renders {
  /** The newest first; null until they are known. */
  readonly all = signal<readonly Render[] | null>(null);
  /** Whether there are older ones than those listed. */
  readonly hasOlder = signal(false);
  /** Why the list is not as it is at the service; null where it is. */
  readonly complaint = signal<string | null>(null);
  /** Why the last action was not done; null where it was. */
  readonly refusal = signal<string | null>(null);
  /** Id of the render whose frames are shown. */
  readonly opened = signal<string | null>(null);
  /** Frames of that render; null until they are known. */
  readonly tasks = signal<readonly RenderTask[] | null>(null);
  /** Ids of renders that an action is under way on. */
  readonly acting = signal<ReadonlySet<string>>(new Set());

  readonly #service: RenderService;
  readonly #changes: RenderChanges;
  #wanted = SHOWN;
  #reading: Promise<void> | null = null;
  #isStale = false;
  /** Number of actions that were done: what was read before one is older than its answer. */
  #acts = 0;
  /** Id of the render that was added last, until its row has taken the keyboard. */
  #added: string | null = null;
  /** State of the opened render that its frames were read in. */
  #tasksOf = "";

  readonly #openedRender = computed(() => this.all.value?.find(({ id }) => id === this.opened.value) ?? null);

  constructor(service: RenderService, changes: RenderChanges) {
    [this.#service, this.#changes] = [service, changes];
  }

  /** Reads the list, and again whenever something changes, until what is returned is called. */
  follow(): () => void {
    this.#changes.start(() => void this.refresh());
    void this.refresh();
    return () => {
      this.#changes.stop();
    };
  }

  /** Reads all anew; while that goes on, another call has it done once more. */
  refresh(): Promise<void> {
    this.#isStale = true;
    this.#reading ??= this.#readWhileStale().finally(() => (this.#reading = null));
    return this.#reading;
  }

  async #readWhileStale(): Promise<void> {
    while (this.#isStale) {
      this.#isStale = false;
      try {
        await this.#readList();
        await this.#readTasks();
        this.complaint.value = null;
      } catch (error) {
        this.#complain(error);
        return;
      }
    }
  }

  async #readList(): Promise<void> {
    const acts = this.#acts;
    let [read, next]: [readonly Render[], string | null] = [[], null];
    do {
      const most = Math.min(this.#wanted - read.length, MOST_IN_PAGE);
      const page = await this.#service.list(most, next);
      [read, next] = [[...read, ...page.renders], page.next];
    } while (next !== null && read.length < this.#wanted);
    if (acts !== this.#acts) return;
    this.all.value = read;
    this.hasOlder.value = next !== null;
  }

  /** Reads the frames of the opened render, where some went into another state. */
  async #readTasks(): Promise<void> {
    const render = this.#openedRender.peek();
    if (!render) return;
    const { id, ready, running, done, failed, canceled } = render;
    const state = [id, ready, running, done, failed, canceled].join(" ");
    if (state === this.#tasksOf) return;
    const tasks = await this.#service.tasks(id);
    if (this.opened.peek() !== id) return;
    [this.tasks.value, this.#tasksOf] = [tasks, state];
  }

  showOlder(): Promise<void> {
    this.#wanted += SHOWN;
    return this.refresh();
  }

  /** Shows the frames of a render, or of none. */
  open(render: string | null): void {
    this.opened.value = render;
    [this.tasks.value, this.#tasksOf] = [null, ""];
    if (render !== null) void this.refresh();
  }

  /** A render that was sent is the newest one. */
  add(render: Render): void {
    this.#acts += 1;
    const others = this.all.peek()?.filter(({ id }) => id !== render.id) ?? [];
    this.all.value = [render, ...others];
    this.#added = render.id;
    this.open(render.id);
  }

  /** Whether a render was just added; that is told once. */
  takeAdded(id: string): boolean {
    const isAdded = this.#added === id;
    if (isAdded) this.#added = null;
    return isAdded;
  }

  async act({ id }: Render, action: RenderAction): Promise<void> {
    if (this.acting.peek().has(id)) return;
    this.acting.value = new Set([...this.acting.peek(), id]);
    this.refusal.value = null;
    try {
      this.#replace(id, await this.#service.act(id, action));
    } catch (error) {
      if (!isAbort(error)) this.refusal.value = told(error);
    } finally {
      this.acting.value = new Set([...this.acting.peek()].filter((other) => other !== id));
    }
    await this.refresh();
  }

  #replace(id: string, render: Render | null): void {
    this.#acts += 1;
    const all = this.all.peek() ?? [];
    this.all.value = render
      ? all.map((each) => (each.id === id ? render : each))
      : all.filter((each) => each.id !== id);
    if (!render && this.opened.peek() === id) this.open(null);
  }

  #complain(error: unknown): void {
    if (!isAbort(error)) this.complaint.value = told(error);
  }
}

function told(error: unknown): string {
  const { message, advice } = complaintOf(error);
  return `${message} ${advice}`.trim();
}
