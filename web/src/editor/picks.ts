/** Clicks on the picture, and points that are dropped on it: what is there is picked, and becomes or gets a focus point. */

import { computed, signal, type ReadonlySignal, type Signal } from "@preact/signals";
import type { Changes } from "../model/changes";
import { freshName } from "../model/pull";
import { restQuality } from "../model/quality";
import { thingName, type Anchor, type FocusPoint } from "../model/shot";
import { HintError } from "../net/errors";
import type { Service } from "../net/service";
import type { ShotDocument } from "./document";
import type { Fail } from "./fail";
import { noCameraHint, noEditsHint } from "./hints";
import type { Playhead } from "./playhead";
import type { PointEdits } from "./point_edits";
import type { Pulls } from "./pulls";

/** What a click on the picture does: it pulls the focus, adds a point to the others, or moves the selected one. */
export const TOOLS = ["pull", "add", "move"] as const;
export type Tool = (typeof TOOLS)[number];

/** In the picture, 0 to 1 from its top left corner. */
export type Place = readonly [number, number];

/** The open shot that is picked in. */
interface Picked {
  readonly document: ShotDocument;
  readonly playhead: Playhead;
  readonly pulls: Pulls;
  readonly pointEdits: PointEdits;
  /** Device pixels that the picture has on screen. */
  readonly box: ReadonlySignal<{ readonly width: number; readonly height: number } | null>;
  /** Name of the selected focus point. */
  readonly selected: Signal<string | null>;
  readonly selectedPoint: ReadonlySignal<FocusPoint | null>;
  /** Whether the points are many that are to be sharp at once. */
  readonly gathers: ReadonlySignal<boolean>;
}

export class Picks {
  /** Place of the pick under way. */
  readonly picking = signal<Place | null>(null);
  /** What a click without Shift and Alt does: what was chosen where that can be done, else what the focus mode suggests. */
  readonly tool = computed<Tool>(() => {
    const chosen = this.#chosen.value;
    const canMove = this.#session.selectedPoint.value !== null;
    if (chosen !== null && (chosen !== "move" || canMove)) return chosen;
    return this.#session.gathers.value ? "add" : "pull";
  });
  readonly #chosen = signal<Tool | null>(null);

  readonly #service: Service;
  readonly #session: Picked;
  readonly #fail: Fail;
  #queue: Promise<void> = Promise.resolve();
  #flight: AbortController | null = null;

  constructor(service: Service, session: Picked, fail: Fail) {
    [this.#service, this.#session, this.#fail] = [service, session, fail];
    session.selected.subscribe((selected) => {
      // The next point that is selected is not meant.
      if (selected === null && this.#chosen.peek() === "move") this.#chosen.value = null;
    });
  }

  choose(tool: Tool): void {
    this.#chosen.value = tool;
  }

  /** What a click with these keys held does: Alt moves, and Shift pulls in place of adding, and adds in place of pulling. */
  toolWith({ shiftKey, altKey }: Pick<MouseEvent, "shiftKey" | "altKey">): Tool {
    if (altKey) return "move";
    if (!shiftKey) return this.tool.value;
    return this.tool.value === "pull" ? "add" : "pull";
  }

  /** A click at a place; one that comes during a pick does nothing. */
  async click(at: Place, tool: Tool): Promise<void> {
    if (this.picking.value) return;
    const moved = this.#session.selectedPoint.value;
    if (tool === "move" && !moved)
      this.#fail(new HintError("No focus point is selected.", "Select the one to move."), () => undefined);
    else if (tool === "move" && moved) await this.move(moved.name, at);
    else await this.#pick(at, (anchor, time) => this.#add(anchor, time, tool !== "add"));
  }

  /**
   * Moves a point to what is at a place, after the picks under way.
   *
   * @param unsaved changes that the picture shows until then.
   */
  move(name: string, at: Place, unsaved?: Changes): Promise<void> {
    const point = { name, identity: this.#session.pointEdits.identityOf(name) };
    return this.#pick(at, async (anchor, time) => {
      await this.#session.pointEdits.move(point, anchor, time, unsaved);
    });
  }

  /** Stops the pick under way, so that the click does nothing. */
  stop(): void {
    this.#flight?.abort();
  }

  /** Resolves when all that was picked is edited. */
  async idle(): Promise<void> {
    await this.#queue;
  }

  async #add(anchor: Anchor, time: number, pulls: boolean): Promise<void> {
    const { document, selected } = this.#session;
    const points = await document.pointsAt(time);
    const name = freshName(
      thingName(anchor.target[0] ?? ""),
      points.map((point) => point.name),
    );
    const changes: Changes = [...document.byPoints(), { type: "addPoint", point: { name, ...anchor } }];
    const isMade = pulls
      ? await this.#session.pulls.pull(name, time, changes)
      : await document.edit(`Add ${name}`, changes);
    if (isMade) selected.value = name;
  }

  /** Picks the surface at a place, after the picks before, and acts on it. */
  #pick(
    at: Place,
    act: (anchor: Anchor, time: number) => Promise<void>,
    time = this.#session.playhead.time.value,
  ): Promise<void> {
    const { document, playhead, box } = this.#session;
    const hint = noEditsHint(document.noEdits.value) ?? (document.hasLens ? null : noCameraHint(document.shot));
    if (hint) this.#fail(hint, () => undefined);
    if (hint || !box.value) return Promise.resolve();
    playhead.pause();
    const quality = restQuality(box.value.width, box.value.height);
    this.#queue = this.#queue.then(async () => {
      this.picking.value = at;
      const flight = (this.#flight = new AbortController());
      try {
        const pick = await this.#service.pick(document.view, time, at, quality, flight.signal);
        this.picking.value = null; // what follows is an edit, which says so
        if (!pick) throw new HintError("There is nothing to focus on there.", "Click on a surface.");
        await act(pick.anchor, time);
      } catch (error) {
        this.#fail(error, () => void this.#pick(at, act, time));
      } finally {
        this.picking.value = null;
      }
    });
    return this.#queue;
  }
}
