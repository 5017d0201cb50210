/** Events of one shot over a WebSocket: its edits, whoever makes them. */

import type { components } from "./schema";

type Json = components["schemas"];
/** The part of a WebSocket that is used. */
type Socket = Pick<WebSocket, "close" | "onopen" | "onclose" | "onmessage">;

/** Wait before a lost connection is opened again, ms; it doubles each time, up to the most. */
const RETRY_MS = { first: 500, most: 15_000 };

export interface EditsListener {
  /** Takes the revision that the edits have come to; null where some may have been missed. */
  onEdits(revision: string | null): void;
}

/** A connection that is to be closed. */
export interface EventLink {
  close(): void;
}

export interface ShotEventsOptions {
  /** Resolves once a lost connection may be opened again. */
  readonly admitted: () => Promise<unknown>;
  readonly connect?: (address: string) => Socket;
}

/**
 * Tells a listener of the edits of a shot.
 *
 * Whenever a connection opens, some may have been missed. Where the service takes no more readers, each try to connect tells that
 * too, so that the listener looks now and then.
 */
export class ShotEvents implements EventLink {
  readonly #address: string;
  readonly #listener: EditsListener;
  readonly #options: ShotEventsOptions;
  #socket: Socket | null = null;
  #isClosed = false;
  #retry: ReturnType<typeof setTimeout> | undefined;
  #waitMs = RETRY_MS.first;

  constructor(address: string, listener: EditsListener, options: ShotEventsOptions) {
    [this.#address, this.#listener, this.#options] = [address, listener, options];
    this.#open();
  }

  close(): void {
    this.#isClosed = true;
    clearTimeout(this.#retry);
    this.#socket?.close();
  }

  #open(): void {
    const socket = this.#options.connect?.(this.#address) ?? new WebSocket(this.#address);
    this.#socket = socket;
    socket.onopen = () => {
      this.#waitMs = RETRY_MS.first;
      this.#tell(null);
    };
    socket.onmessage = ({ data }) => {
      const told = JSON.parse(String(data)) as Json["Event"] | Json["EventGap"];
      if (!("topic" in told)) this.#tell(null);
      else if (told.topic === "edits") this.#tell(told.data.revision ?? null);
    };
    socket.onclose = () => {
      if (!this.#isClosed) this.#openLater();
    };
  }

  #tell(revision: string | null): void {
    if (!this.#isClosed) this.#listener.onEdits(revision);
  }

  #openLater(): void {
    this.#retry = setTimeout(() => void this.#openAgain(), this.#waitMs);
    this.#waitMs = Math.min(2 * this.#waitMs, RETRY_MS.most);
  }

  async #openAgain(): Promise<void> {
    const isAdmitted = await this.#options.admitted().then(
      () => true,
      () => false,
    );
    if (this.#isClosed) return;
    if (!isAdmitted) {
      this.#openLater();
      return;
    }
    this.#tell(null);
    this.#open();
  }
}

/** Address of the events of a shot's edits. */
export function shotEventsAddress(base: string, shot: string): string {
  const address = new URL(`/v1/events?topic=edits&shot=${encodeURIComponent(shot)}`, base);
  address.protocol = address.protocol.replace("http", "ws");
  return address.href;
}
