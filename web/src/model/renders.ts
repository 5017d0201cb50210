/** Renders: jobs of many frames at the service; what is told of them, and what can be done with them. */

import type { components } from "../net/schema";
import { countProducts } from "./deliverables";

export type Render = components["schemas"]["Render"];
export type RenderRequest = components["schemas"]["RenderRequest"];
export type RenderPlan = components["schemas"]["RenderPlan"];
export type RenderTask = components["schemas"]["RenderTask"];
export type TaskState = RenderTask["state"];

export const RENDER_ACTIONS = ["pause", "resume", "accept", "retry", "cancel", "remove"] as const;
export type RenderAction = (typeof RENDER_ACTIONS)[number];

/** A page of a list of renders, the newest first. */
export interface RenderPage {
  readonly renders: readonly Render[];
  /** Id of the render that older ones are listed after; null at the end. */
  readonly next: string | null;
}

/** Whether all frames of a render have ended. */
export function hasDrawn({ ready, running }: Pick<Render, "ready" | "running">): boolean {
  return ready + running === 0;
}

/** Whether all frames and products of a render have ended. */
export function hasEnded(render: Pick<Render, "ready" | "running" | "products">): boolean {
  return hasDrawn(render) && countProducts(render, ["waiting", "running"]) === 0;
}

/** Whether the service would take an action on a render. */
export function isTaken(action: RenderAction, render: Render): boolean {
  const { state, failed, canceled } = render;
  switch (action) {
    case "pause":
      return state === "queued" || state === "running";
    case "resume":
      return state === "paused" || state === "pause-requested";
    case "accept":
      return state === "failed" || state === "canceled";
    case "retry":
      return failed + canceled + countProducts(render, ["failed", "canceled"]) > 0;
    case "cancel":
      return !hasEnded(render) && state !== "cancel-requested";
    case "remove":
      return hasEnded(render);
  }
}

/** Renders that a new one may wait for, the newest first: those that are not done, and those that are chosen already. */
export function waitableOf(all: readonly Render[], chosen: readonly Render[]): readonly Render[] {
  const isChosen = (id: string): boolean => chosen.some((each) => each.id === id);
  const lost = chosen.filter(({ id }) => !all.some((each) => each.id === id));
  return [...all.filter(({ id, state }) => state !== "done" || isChosen(id)), ...lost];
}

/** The state of a render among others for people. */
export function stateInWords(render: Render, others: readonly Render[]): string {
  const { state, running, waitsFor, accepted } = render;
  switch (state) {
    case "queued":
      return waitsFor.length > 0 ? `Waits for ${neededInWords(waitsFor, others)}` : "Waits for its turn";
    case "running":
      if (running > 0) return "Drawing";
      return countProducts(render, ["running"]) > 0 ? "Making files" : "Waits to go on";
    case "pause-requested":
      return "Pauses after this frame";
    case "paused":
      return "Paused";
    case "cancel-requested":
      return "Is being cancelled";
    case "canceled":
      return "Cancelled";
    case "failed":
      return "Ended with failures";
    case "done":
      return accepted ? "Accepted as it is" : "Done";
  }
}

/** Most renders that are told by their names. */
const MOST_NAMED = 3;

/** Renders that another one waits for: by their names where they are few and known, else how many. */
function neededInWords(ids: readonly string[], others: readonly Render[]): string {
  const names = others.filter(({ id }) => ids.includes(id)).map(({ name }) => name);
  const isTold = names.length === ids.length && names.length <= MOST_NAMED;
  return isTold ? names.join(", ") : plural(ids.length, "other render");
}

/** How far a render is: "25 of 96 frames, 2 failed". */
export function progressInWords(render: Render): string {
  const { done, count, failed, canceled, products = [] } = render;
  const made = `${inWords(countProducts(render, ["done"]))} of ${plural(products.length, "product")}`;
  const parts = [
    count > 0 ? `${inWords(done)} of ${plural(count, "frame")}` : "",
    failed > 0 ? `${inWords(failed)} failed` : "",
    canceled > 0 ? `${inWords(canceled)} given up` : "",
    products.length > 0 ? made : "",
  ];
  return parts.filter(Boolean).join(", ");
}

/** A duration that nobody knows to the second. */
export function durationInWords(seconds: number): string {
  if (seconds < 90) return `${Math.max(1, Math.round(seconds))} s`;
  const minutes = Math.round(seconds / 60);
  if (minutes < 90) return `${minutes} min`;
  const hours = Math.round(minutes / 60);
  if (hours < 48) return hours < 10 ? `${Math.floor(minutes / 60)} h ${minutes % 60} min` : `${hours} h`;
  return `${Math.round(hours / 24)} days`;
}

/** What a render would be: "96 frames, about 12 min of work". */
export function planInWords({ count, secondsOfProcessor }: Pick<RenderPlan, "count" | "secondsOfProcessor">): string {
  if (count === 0) return "No frame is drawn";
  return `${plural(count, "frame")}, about ${durationInWords(secondsOfProcessor)} of work`;
}

/** The picture that a render would be of: "480 × 360 px, Planar 50 mm f/1.4 at f/2, on vision3_500t_5219". */
export function settingsInWords({ settings }: Pick<RenderPlan, "settings">): string {
  if (!settings) return "";
  const { width, height, lensName, focalLengthMm, fStop, film } = settings;
  const stop = fStop > 0 ? ` at f/${Number(fStop.toPrecision(2))}` : "";
  const lens = lensName === "" ? `${Number(focalLengthMm.toPrecision(3))} mm` : lensName;
  return `${width} × ${height} px, ${lens}${stop}${film === null ? "" : `, on ${film}`}`;
}

export function plural(count: number, noun: string): string {
  return `${inWords(count)} ${noun}${count === 1 ? "" : "s"}`;
}

function inWords(count: number): string {
  return count.toLocaleString("en");
}

export const TASK_NAMES: Readonly<Record<TaskState, string>> = {
  done: "drawn",
  failed: "failed",
  running: "being drawn",
  ready: "waiting",
  canceled: "given up",
};

/** In the order in which one of them stands for several frames: the first that any has. */
const TELLING: readonly TaskState[] = ["failed", "running", "ready", "canceled", "done"];

/** Frames, one after the other, that are shown as one. */
export interface FrameGroup {
  readonly tasks: readonly RenderTask[];
  /** What is told first of it. */
  readonly state: TaskState;
  /** For people: "Frames 1 to 84: 80 drawn, 4 failed". */
  readonly label: string;
}

/** Frames as so many groups at most, all of one size but the last. */
export function groupsOf(tasks: readonly RenderTask[], most: number): readonly FrameGroup[] {
  const size = Math.max(1, Math.ceil(tasks.length / most));
  return Array.from({ length: Math.ceil(tasks.length / size) }, (_, at) =>
    groupOf(tasks.slice(at * size, (at + 1) * size)),
  );
}

function groupOf(tasks: readonly RenderTask[]): FrameGroup {
  const counted = TELLING.map((state) => ({ state, count: tasks.filter((task) => task.state === state).length }));
  const there = counted.filter(({ count }) => count > 0);
  const [first, last] = [tasks[0]?.frame ?? 0, tasks.at(-1)?.frame ?? 0];
  const named = there.map(({ state, count }) => `${inWords(count)} ${TASK_NAMES[state]}`).join(", ");
  const state = there[0]?.state ?? "ready";
  const label = tasks.length === 1 ? `Frame ${first}: ${TASK_NAMES[state]}` : `Frames ${first} to ${last}: ${named}`;
  return { tasks, state, label };
}

/** Frames that failed for the same reason. */
export interface Failure {
  readonly error: string;
  readonly frames: readonly number[];
}

/** What went wrong with frames that could not be drawn, the most frequent first. */
export function failuresOf(tasks: readonly RenderTask[]): readonly Failure[] {
  const byError = new Map<string, number[]>();
  for (const { state, frame, attempts } of tasks) {
    if (state !== "failed") continue;
    const error = attempts.at(-1)?.error ?? "No reason is known.";
    byError.set(error, [...(byError.get(error) ?? []), frame]);
  }
  const failures = [...byError].map(([error, frames]) => ({ error, frames }));
  return failures.toSorted((one, other) => other.frames.length - one.frames.length);
}

/** Frames in rising order for people: "1–4, 8". */
export function framesInWords(frames: readonly number[]): string {
  const runs: [number, number][] = [];
  for (const frame of frames) {
    const last = runs.at(-1);
    if (last?.[1] === frame - 1) last[1] = frame;
    else runs.push([frame, frame]);
  }
  return runs.map(([first, last]) => (first === last ? `${first}` : `${first}–${last}`)).join(", ");
}

/** The frame whose picture was stored last; null where none is. */
export function lastDrawn(tasks: readonly RenderTask[]): RenderTask | null {
  const endOf = ({ attempts }: RenderTask): string => attempts.at(-1)?.endedAt ?? "";
  return tasks
    .filter(({ state }) => state === "done")
    .reduce<RenderTask | null>((last, task) => (last === null || endOf(task) >= endOf(last) ? task : last), null);
}
