/**
 * The entity tags of what was read, so that an edit can say what it was made upon (`If-Match`): what somebody else changed
 * since is then not overwritten unseen.
 */

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
  reading(): (thing: string, tag: string) => void {
    const epoch = this.#epoch;
    return (thing, tag) => {
      const known = this.#tags.get(thing);
      if (epoch === this.#epoch && (!known || known.since < epoch)) this.#tags.set(thing, { tag, since: epoch });
    };
  }

  /** The tag that an edit of a thing is made upon; null where none is known. */
  of(thing: string): string | null {
    return this.#tags.get(thing)?.tag ?? null;
  }

  /** From now on what is read is newer than all that is known. */
  turn(): void {
    this.#epoch += 1;
  }

  /** Takes the tag that the answer to an edit has. */
  set(thing: string, tag: string): void {
    this.#tags.set(thing, { tag, since: this.#epoch });
  }

  forget(...things: readonly string[]): void {
    for (const thing of things) this.#tags.delete(thing);
  }

  clear(): void {
    this.#tags.clear();
    this.turn();
  }
}
