/**
 * Entity tags of what was read, so that an edit can name what it is made upon (`If-Match`): a change of somebody else is then
 * not overwritten unseen. Resources go by their addresses below the shot, as the answer to an edit has them.
 */

import type { Change, Changes } from "../model/changes";

export const [CAMERA, POINTS] = ["camera", "focus-points"];

export function pointAddress(name: string): string {
  return `${POINTS}/${name}`;
}

/** Address of the resource that a change is made upon. */
export function addressOf(change: Change): string {
  if (change.type === "addPoint" || change.type === "rack") return POINTS;
  return "name" in change ? pointAddress(change.name) : CAMERA;
}

export class TagBook {
  readonly #tags = new Map<string, { readonly tag: string; readonly since: number }>();
  /** Goes up whenever all that was read is read anew. */
  #epoch = 0;

  /**
   * Starts a reading.
   *
   * What it brings counts unless an edit was sent meanwhile, which it may not have seen. And of what is read more than
   * once, as at several times, the first counts: that is what the person may have seen.
   */
  reading(): (address: string, tag: string) => void {
    const epoch = this.#epoch;
    return (address, tag) => {
      const known = this.#tags.get(address);
      if (epoch === this.#epoch && (!known || known.since < epoch)) this.#tags.set(address, { tag, since: epoch });
    };
  }

  /** The header of an edit that is made upon what was read; null where a tag of that is not known. */
  ifMatch(changes: Changes): string | null {
    const added = changes.map((change) => (change.type === "addPoint" ? pointAddress(change.point.name ?? "") : ""));
    const addresses = new Set(changes.map(addressOf).filter((address) => !added.includes(address)));
    const tags = [...addresses].map((address) => this.#tags.get(address)?.tag);
    return tags.every((tag) => tag !== undefined) ? tags.join(", ") : null;
  }

  /** From now on what is read is newer than all that is known. */
  turn(): void {
    this.#epoch += 1;
  }

  /** Takes the tags that the answer to an edit has; null where there is nothing any more. */
  take(changed: readonly { readonly resource: string; readonly etag: string | null }[]): void {
    for (const { resource, etag } of changed) {
      if (etag === null) this.#tags.delete(resource);
      else this.#tags.set(resource, { tag: etag, since: this.#epoch });
    }
  }

  forget(changes: Changes): void {
    for (const change of changes) this.#tags.delete(addressOf(change));
  }

  clear(): void {
    this.#tags.clear();
    this.turn();
  }
}
