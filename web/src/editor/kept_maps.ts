/** Focus maps of pictures that were seen, by time, held to a budget of memory; those that were used least recently go first. */

const MOST_BYTES = 96 * 2 ** 20;

export interface KeptMap {
  /** Encoded. */
  readonly data: ArrayBuffer;
  /** Whether it is that of an exact picture; else it is coarser. */
  readonly isExact: boolean;
}

export class KeptMaps {
  readonly #maps = new Map<number, KeptMap>();
  readonly #mostBytes: number;
  #bytes = 0;

  constructor(mostBytes: number = MOST_BYTES) {
    this.#mostBytes = mostBytes;
  }

  get(time: number): KeptMap | null {
    const map = this.#maps.get(time);
    if (!map) return null;
    this.#maps.delete(time);
    this.#maps.set(time, map);
    return map;
  }

  /** Keeps a map; one of a preview does not take the place of an exact one. */
  put(time: number, map: KeptMap): void {
    const before = this.get(time);
    if (before?.isExact && !map.isExact) return;
    this.#bytes += map.data.byteLength - (before?.data.byteLength ?? 0);
    this.#maps.set(time, map);
    for (const [oldest, { data }] of this.#maps) {
      if (this.#bytes <= this.#mostBytes) break;
      this.#maps.delete(oldest);
      this.#bytes -= data.byteLength;
    }
  }

  clear(): void {
    this.#maps.clear();
    this.#bytes = 0;
  }
}
