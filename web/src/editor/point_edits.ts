/** Edits of focus points as a whole: their names, what they are, whether they count, and racks between them. */

import type { ReadonlySignal, Signal } from "@preact/signals";
import { setAttribute, setKind, type Changes } from "../model/changes";
import { freshName } from "../model/pull";
import { primName, type Ease, type FocusPoint, type PointColor, type PointSettings } from "../model/shot";
import { HintError } from "../net/errors";
import type { ShotDocument } from "./document";

export class PointEdits {
  readonly #document: ShotDocument;
  readonly #time: ReadonlySignal<number>;
  /** Name of the selected focus point. */
  readonly #selected: Signal<string | null>;

  constructor(document: ShotDocument, time: ReadonlySignal<number>, selected: Signal<string | null>) {
    [this.#document, this.#time, this.#selected] = [document, time, selected];
  }

  /** Gives a point another name, made of what is typed; resolves to whether it has another one then. */
  async rename(point: FocusPoint, typed: string): Promise<boolean> {
    const others = this.#document.points.value.map(({ name }) => name).filter((name) => name !== point.name);
    const newName = freshName(typed.trim(), others);
    if (newName === point.name) return false;
    const change = { type: "renamePoint", name: point.name, newName } as const;
    const isMade = await this.#onPoint(`Rename a point to ${newName}`, point, [change]);
    if (isMade && this.#selected.value === point.name) this.#selected.value = newName;
    return isMade;
  }

  /** Lets a point follow the bounds of a part from where it is now, or its surface again; resolves to whether it does. */
  follow(point: FocusPoint, part: string): Promise<boolean> {
    const label = part === "" ? `Put ${point.name} on its surface` : `Let ${point.name} follow ${primName(part)}`;
    const change = { type: "followPart", name: point.name, part: part || null, time: this.#time.value } as const;
    return this.#document.edit(label, [change]);
  }

  setColor(point: FocusPoint, color: PointColor): Promise<boolean> {
    const label = color === "none" ? `Take the colour off ${point.name}` : `Colour ${point.name} ${color}`;
    return this.#alter(label, point, { color });
  }

  /** Puts a point in a group, with an empty name in none; resolves to whether it is in another one then. */
  async setGroup(point: FocusPoint, typed: string): Promise<boolean> {
    const group = typed.trim();
    if (group === point.group) return false;
    const label = group === "" ? `Take ${point.name} out of ${point.group}` : `Put ${point.name} in ${group}`;
    return this.#alter(label, point, { group });
  }

  /** Lets all points of a group count, or none of them. */
  setGroupEnabled(group: string, points: readonly FocusPoint[], enabled: boolean): Promise<boolean> {
    const others = points.filter(({ settings }) => settings.enabled !== enabled);
    const changes = others.flatMap((point) => setAttribute(point, "enabled", Number(enabled), this.#time.value));
    return this.#document.edit(`${enabled ? "Enable" : "Disable"} ${group}`, changes);
  }

  #alter(label: string, point: FocusPoint, values: Partial<Pick<FocusPoint, "color" | "group">>): Promise<boolean> {
    return this.#onPoint(label, point, [{ type: "alterPoint", name: point.name, values, time: this.#time.value }]);
  }

  /** Makes an edit of a point, unless an edit before it, such as an undo, removes the point. */
  #onPoint(label: string, { name }: FocusPoint, changes: Changes): Promise<boolean> {
    const time = this.#time.value;
    return this.#document.edit(label, async () => {
      const points = await this.#document.pointsAt(time);
      if (points.some((point) => point.name === name)) return changes;
      throw new HintError(`There is no ${name} any more.`, "Select another point.");
    });
  }

  setKind(point: FocusPoint, kind: PointSettings["kind"]): void {
    void this.#document.edit(`Make ${point.name} ${kind}`, setKind(point, kind, this.#time.value));
  }

  setEnabled(point: FocusPoint, enabled: boolean): Promise<boolean> {
    const change = setAttribute(point, "enabled", Number(enabled), this.#time.value);
    return this.#document.edit(`${enabled ? "Enable" : "Disable"} ${point.name}`, change);
  }

  /** Racks the focus from one point to another, from now on. */
  rack(from: FocusPoint, to: string, frames: number, ease: Ease): void {
    const start = this.#time.value;
    const rack = { from: from.name, to, start, end: start + frames, ease };
    void this.#document.edit(`Rack to ${to}`, [...this.#document.byPoints(), { type: "rack", rack }]);
  }

  remove(point: FocusPoint): void {
    if (this.#selected.value === point.name) this.#selected.value = null;
    void this.#document.edit(`Remove ${point.name}`, [{ type: "removePoint", name: point.name }]);
  }
}
