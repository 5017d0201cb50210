/** Edits of focus points as a whole: their names, what they are, whether they count, and racks between them. */

import type { ReadonlySignal, Signal } from "@preact/signals";
import {
  moveInWorld,
  moveOnto,
  setAttribute,
  setKind,
  toggleKey,
  type Changes,
  type SimpleAttribute,
} from "../model/changes";
import { freshName } from "../model/pull";
import { rackProblem } from "../model/rack";
import { primName, type Anchor, type Ease, type FocusPoint, type PointColor, type PointSettings } from "../model/shot";
import type { Vector } from "../model/vector";
import { HintError } from "../net/errors";
import type { ShotDocument } from "./document";
import { noPointHint } from "./hints";
import type { PointNames } from "./point_names";

interface Named {
  readonly name: string;
  /** By default that of the name now. */
  readonly identity?: number;
}

interface EditOptions {
  /** Of the edit; by default the present one. */
  readonly time?: number;
  /** Changes that the picture shows until it is made. */
  readonly unsaved?: Changes | undefined;
  readonly onMade?: () => void;
}

export class PointEdits {
  readonly #document: ShotDocument;
  readonly #time: ReadonlySignal<number>;
  /** Name of the selected focus point. */
  readonly #selected: Signal<string | null>;
  readonly #names: PointNames;

  constructor(
    document: ShotDocument,
    time: ReadonlySignal<number>,
    selected: Signal<string | null>,
    names: PointNames,
  ) {
    [this.#document, this.#time, this.#selected, this.#names] = [document, time, selected, names];
  }

  /** An identity that a point keeps when it is renamed; for the keys of lists. */
  identityOf(name: string): number {
    return this.#names.identityOf(name);
  }

  /** Returns a function that reads what a point is at a time by then; it throws a HintError where the point is gone. */
  following(point: Named): (time: number) => Promise<FocusPoint> {
    const identity = point.identity ?? this.identityOf(point.name);
    return async (time) => this.#now(await this.#document.pointsAt(time), point.name, identity);
  }

  /**
   * Moves a point to a place of a surface at a time.
   *
   * @param unsaved changes that the picture shows until then.
   */
  move(point: Named, anchor: Anchor, time: number, unsaved?: Changes): Promise<boolean> {
    const label = `Move ${point.name}`;
    return this.#onPoint(label, point, (now) => moveOnto(now, { anchor }, time), { time, unsaved });
  }

  /** Moves a point to a place of the world at a time; it stays with what it is on. As `move`. */
  moveInWorld(point: Named, positionM: Vector, time: number, unsaved?: Changes): Promise<boolean> {
    const label = `Move ${point.name}`;
    return this.#onPoint(label, point, ({ name }) => moveInWorld(name, positionM, time), { time, unsaved });
  }

  /** Gives a point another name, made of what is typed; resolves to whether it has another one then. */
  async rename(point: FocusPoint, typed: string): Promise<boolean> {
    const others = this.#document.points.value.map(({ name }) => name).filter((name) => name !== point.name);
    const newName = freshName(typed.trim(), others);
    if (newName === point.name) return false;
    let from = point.name;
    const isMade = await this.#onPoint(
      `Rename a point to ${newName}`,
      point,
      ({ name }) => [{ type: "renamePoint", name: (from = name), newName }],
      {
        onMade: () => {
          this.#names.rename(from, newName);
        },
      },
    );
    if (isMade && this.#selected.value === point.name) this.#selected.value = newName;
    return isMade;
  }

  /** Lets a point follow the bounds of a part from where it is now, or its surface again; resolves to whether it does. */
  follow(point: FocusPoint, part: string): Promise<boolean> {
    const label = part === "" ? `Put ${point.name} on its surface` : `Let ${point.name} follow ${primName(part)}`;
    return this.#onPoint(label, point, ({ name }, time) => [{ type: "followPart", name, part: part || null, time }]);
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
  setGroupEnabled(group: string, enabled: boolean): Promise<boolean> {
    const label = `${enabled ? "Enable" : "Disable"} ${group}`;
    return this.#onPoints(label, (points, time) => {
      const members = points.filter((point) => point.group === group);
      const others = members.filter(({ settings }) => settings.enabled !== enabled);
      return others.flatMap((point) => setAttribute(point, "enabled", Number(enabled), time));
    });
  }

  setKind(point: FocusPoint, kind: PointSettings["kind"]): Promise<boolean> {
    return this.#onPoint(`Make ${point.name} ${kind}`, point, (now, time) => setKind(now, kind, time));
  }

  setEnabled(point: FocusPoint, enabled: boolean): Promise<boolean> {
    const label = `${enabled ? "Enable" : "Disable"} ${point.name}`;
    return this.#onPoint(label, point, (now, time) => setAttribute(now, "enabled", Number(enabled), time));
  }

  /** Sets or removes a key of a point at the present time. */
  toggleKey(point: FocusPoint, attribute: SimpleAttribute): Promise<boolean> {
    return this.#onPoint(`Key of ${point.name}`, point, (now, time) => toggleKey(now, attribute, time));
  }

  remove(point: FocusPoint): Promise<boolean> {
    if (this.#selected.value === point.name) this.#selected.value = null;
    return this.#onPoint(`Remove ${point.name}`, point, ({ name }) => [{ type: "removePoint", name }]);
  }

  /** Racks the focus from one point to another, from now on; resolves to whether it does. */
  rack(from: FocusPoint, to: string, frames: number, ease: Ease): Promise<boolean> {
    const start = this.#time.value;
    const end = start + frames;
    const [leavingIdentity, comingIdentity] = [this.identityOf(from.name), this.identityOf(to)];
    return this.#onPoints(`Rack to ${to}`, (points) => {
      const leaving = this.#now(points, from.name, leavingIdentity);
      const coming = this.#now(points, to, comingIdentity);
      const problem = rackProblem(leaving, coming, { start, end });
      if (problem !== null)
        throw new HintError(problem, "Rack from another frame, over fewer frames, or remove the key.");
      const rack = { from: leaving.name, to: coming.name, start, end, ease };
      return [...this.#document.byPoints(), { type: "rack", rack }];
    });
  }

  #alter(label: string, point: FocusPoint, values: Partial<Pick<FocusPoint, "color" | "group">>): Promise<boolean> {
    return this.#onPoint(label, point, ({ name }, time) => [{ type: "alterPoint", name, values, time }]);
  }

  /** Makes an edit of a point, also where edits before it rename it, unless one of them removes it or takes its name back. */
  #onPoint(
    label: string,
    point: Named,
    changesOf: (now: FocusPoint, time: number) => Changes,
    options: EditOptions = {},
  ): Promise<boolean> {
    const identity = point.identity ?? this.identityOf(point.name);
    const edit = (points: readonly FocusPoint[], time: number): Changes => {
      return changesOf(this.#now(points, point.name, identity), time);
    };
    return this.#onPoints(label, edit, options);
  }

  /** A point as it is now, by its identity. Throws a HintError: it is gone. */
  #now(points: readonly FocusPoint[], name: string, identity: number): FocusPoint {
    const now = points.find((point) => this.identityOf(point.name) === identity);
    if (!now) throw noPointHint(name);
    return now;
  }

  /** Makes an edit of the points as the edits before it leave them. */
  #onPoints(
    label: string,
    changesOf: (points: readonly FocusPoint[], time: number) => Changes,
    { time = this.#time.value, unsaved, onMade }: EditOptions = {},
  ): Promise<boolean> {
    const changes = async (): Promise<Changes> => changesOf(await this.#document.pointsAt(time), time);
    return this.#document.edit(label, changes, unsaved, undefined, onMade);
  }
}
