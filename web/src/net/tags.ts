/**
 * Entity tags of the resources that were read, for the condition (`If-Match`) of an edit: a change by another editor is then not
 * overwritten unseen. A resource goes by its address below the shot, as in the answer to an edit.
 */

import type { Change, Changes } from "../model/changes";
import type { View } from "./view";

export const [CAMERA, POINTS] = ["camera", "focus-points"];
const NOTES = "notes";

export function pointAddress(name: string): string {
  return `${POINTS}/${name}`;
}

export function noteAddress(id: string): string {
  return `${NOTES}/${id}`;
}

/** Address of the resource that a change needs unchanged. */
export function addressOf(change: Change): string {
  if (change.type === "addPoint" || change.type === "rack") return POINTS;
  if (change.type === "createCamera" || change.type === "duplicateCamera") return CAMERA;
  if (change.type === "addNote") return NOTES;
  if (change.type === "editNote" || change.type === "deleteNote") return noteAddress(change.id);
  return "name" in change ? pointAddress(change.name) : CAMERA;
}

export class TagBook {
  readonly #tags = new Map<string, { readonly tag: string; readonly since: number }>();
  /** Goes up whenever everything is read again. */
  #epoch = 0;

  /**
   * Starts a reading.
   *
   * Its tags count unless an edit was sent meanwhile, which they may not include. Of tags that are read more than once, as at
   * several times, the first counts: the person may have seen that state.
   */
  reading(): (address: string, tag: string) => void {
    const epoch = this.#epoch;
    return (address, tag) => {
      const known = this.#tags.get(address);
      if (epoch === this.#epoch && (!known || known.since < epoch)) this.#tags.set(address, { tag, since: epoch });
    };
  }

  /**
   * The `If-Match` header of an edit; null where the tag of a resource is not known. A note is added whatever others have added: it
   * is in nobody's way.
   */
  ifMatch(changes: Changes): string | null {
    const added = changes.map((change) => (change.type === "addPoint" ? pointAddress(change.point.name ?? "") : NOTES));
    const addresses = new Set(changes.map(addressOf).filter((address) => !added.includes(address)));
    const tags = [...addresses].map((address) => this.#tags.get(address)?.tag);
    return tags.length > 0 && tags.every((tag) => tag !== undefined) ? tags.join(", ") : null;
  }

  /** Makes tags that are read from now on newer than all known ones. */
  turn(): void {
    this.#epoch += 1;
  }

  /** Takes the tags of the answer to an edit; null for a resource that is gone. */
  take(changed: readonly { readonly resource: string; readonly etag: string | null }[]): void {
    for (const { resource, etag } of changed) {
      if (etag === null) this.#tags.delete(resource);
      else this.#tags.set(resource, { tag: etag, since: this.#epoch });
    }
  }

  forget(changes: Changes): void {
    for (const change of changes) this.#tags.delete(addressOf(change));
  }

  /** Forgets all but the tags of notes: these are read anew where the history says that notes have changed. */
  clear(): void {
    for (const address of [...this.#tags.keys()]) if (!address.startsWith(`${NOTES}/`)) this.#tags.delete(address);
    this.turn();
  }
}

/** Tags of all views that were read. */
export class TagBooks {
  readonly #books = new Map<string, TagBook>();

  of(view: View): TagBook {
    const name = `${view.shot} ${view.camera ?? ""}`;
    const book = this.#books.get(name) ?? new TagBook();
    this.#books.set(name, book);
    return book;
  }

  /** Makes tags of a shot that are read from now on newer than all known ones. */
  turn(shot: string): void {
    for (const book of this.#ofShot(shot)) book.turn();
  }

  /** Acts on all edits of a shot, which makes its tags invalid. */
  async asWhole<Value>(shot: string, act: () => Promise<Value>): Promise<Value> {
    try {
      return await act();
    } finally {
      for (const book of this.#ofShot(shot)) book.clear();
    }
  }

  #ofShot(shot: string): TagBook[] {
    return [...this.#books].filter(([view]) => view.startsWith(`${shot} `)).map(([, book]) => book);
  }
}
