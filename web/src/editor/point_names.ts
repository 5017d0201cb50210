/** Names of the focus points, through their renamings. */

export class PointNames {
  /** By the names of points. */
  readonly #identities = new Map<string, number>();

  /** An identity that a point keeps when it is renamed; for the keys of lists. */
  identityOf(name: string): number {
    const identity = this.#identities.get(name) ?? this.#identities.size;
    this.#identities.set(name, identity);
    return identity;
  }

  /** Notes that a point has another name; what had that one before, and is gone, gets the old one. */
  rename(from: string, to: string): void {
    const [identity, replaced] = [this.identityOf(from), this.identityOf(to)];
    this.#identities.set(to, identity).set(from, replaced);
  }

  /** Returns a function that tells the name which a point has by then. */
  follow(name: string): () => string {
    const identity = this.identityOf(name);
    return () => [...this.#identities].find(([, other]) => other === identity)?.[0] ?? name;
  }
}
