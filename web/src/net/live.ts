/**
 * Live pictures over a WebSocket. What is wanted goes out at once and the service looks at the newest alone; what comes is
 * acknowledged once it is on screen, so that no more pictures are on their way than are looked at.
 */

import { toReadout, type Json } from "./convert";
import { errorOf } from "./errors";
import type { LiveEar, LiveLink, Wish } from "./live_link";
import { cameraOf, type View } from "./view";

/** The part of a WebSocket that is used. */
export type Socket = Pick<WebSocket, "send" | "close" | "binaryType" | "onopen" | "onclose" | "onmessage">;

/** How long to wait before a lost connection is tried again, ms; twice as long each time, to the most. */
const AGAIN_MS = { first: 500, most: 15_000 };
/** Requests that nothing has come of yet. */
const MOST_UNANSWERED = 2;

export class LiveSocket implements LiveLink {
  readonly #address: string;
  readonly #view: View;
  readonly #ear: LiveEar;
  readonly #connect: (address: string) => Socket;
  #socket: Socket | null = null;
  #isOpen = false;
  #isClosed = false;
  #again: ReturnType<typeof setTimeout> | undefined;
  #waitMs = AGAIN_MS.first;
  /** Of those whose pictures may still come. */
  readonly #wishes = new Map<number, Wish>();
  #asked = 0;
  #answered = 0;

  constructor(
    address: string,
    view: View,
    ear: LiveEar,
    connect: (address: string) => Socket = (to) => new WebSocket(to),
  ) {
    [this.#address, this.#view, this.#ear, this.#connect] = [address, view, ear, connect];
    this.#open();
  }

  get free(): boolean {
    return this.#asked - this.#answered < MOST_UNANSWERED;
  }

  want(wish: Wish): void {
    this.#asked += 1;
    this.#wishes.set(this.#asked, wish);
    if (this.#isOpen) this.#send(this.#asked, wish);
  }

  forget(): void {
    if (this.#wishes.size === 0) return;
    this.#wishes.clear();
    this.#answered = this.#asked;
    if (this.#isOpen) this.#socket?.send(JSON.stringify({ stop: true } satisfies Json["LiveStop"]));
  }

  close(): void {
    this.#isClosed = true;
    clearTimeout(this.#again);
    this.#wishes.clear();
    this.#socket?.close();
  }

  #open(): void {
    const socket = this.#connect(this.#address);
    this.#socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.#isOpen = true;
      this.#waitMs = AGAIN_MS.first;
      const newest = this.#wishes.get(this.#asked);
      if (newest) this.#send(this.#asked, newest);
      this.#ear.onOpen(true);
    };
    socket.onmessage = ({ data }) => {
      if (!this.#isClosed) this.#hear(data);
    };
    socket.onclose = () => {
      this.#isOpen = false;
      if (this.#isClosed) return;
      this.#wishes.clear();
      this.#answered = this.#asked;
      this.#ear.onOpen(false);
      this.#again = setTimeout(() => {
        this.#open();
      }, this.#waitMs);
      this.#waitMs = Math.min(2 * this.#waitMs, AGAIN_MS.most);
    };
  }

  #send(id: number, { time, quality, tried, moving }: Wish): void {
    const { width, height, rays, layers, supersample, motion, motionBy } = quality;
    const asked: Json["LiveRequest"] = {
      id,
      ...cameraOf(this.#view),
      ...{ time, width, height, rays, layers, supersample, motion, motionBy, moving },
      ...(tried.length > 0 && { changes: tried }),
    };
    this.#socket?.send(JSON.stringify(asked));
  }

  #hear(data: unknown): void {
    if (data instanceof ArrayBuffer) {
      const [head, picture] = parted(data);
      const wish = this.#answer(head.id);
      const { stage, width, height, timing } = head;
      const blob = new Blob([picture], { type: `image/${head.format}` });
      const said = { blob, stage, width, height, rays: timing.rays, share: timing.share, tookMs: timing.answeredMs };
      const looked = wish ? this.#ear.onPicture(said, wish) : Promise.resolve();
      const acknowledge = (): void => {
        if (this.#isOpen) this.#socket?.send(JSON.stringify({ ack: head.picture } satisfies Json["LiveAck"]));
      };
      void looked.then(acknowledge, acknowledge);
      return;
    }
    const said = JSON.parse(String(data)) as Json["LiveReadout"] | Json["LiveProblem"];
    const wish = this.#answer(said.id);
    if ("problem" in said) {
      // What becomes of those before the newest is nobody's business any more.
      if (said.id === null || (wish && said.id === this.#asked)) this.#ear.onError(errorOf(said.status, said.problem));
    } else if (wish) this.#ear.onReadout(toReadout(said.readout), wish);
  }

  /** The wish that something is an answer to; those before it are given up. */
  #answer(id: number | null): Wish | undefined {
    if (id === null) return undefined;
    this.#answered = Math.max(this.#answered, id);
    for (const older of this.#wishes.keys()) if (older < id) this.#wishes.delete(older);
    return this.#wishes.get(id);
  }
}

/** A picture and what stands before it: the length of the head, the head, the picture. */
function parted(message: ArrayBuffer): [Json["LivePictureHead"], ArrayBuffer] {
  const end = 4 + new DataView(message).getUint32(0);
  const head = new TextDecoder().decode(message.slice(4, end));
  return [JSON.parse(head) as Json["LivePictureHead"], message.slice(end)];
}

/** Where the live pictures of a shot are. */
export function liveAddress(base: string, shot: string): string {
  const address = new URL(`/v1/shots/${encodeURIComponent(shot)}/live`, base);
  address.protocol = address.protocol.replace("http", "ws");
  return address.href;
}
