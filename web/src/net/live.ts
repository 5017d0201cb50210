/**
 * Live pictures over a WebSocket. A request is sent at once, and the service serves the newest. A picture is acknowledged once it
 * is on screen, so that no more pictures are sent than are shown.
 */

import { othersOf } from "../model/viewers";
import { toReadout, type Json } from "./convert";
import { errorOf, ServiceError } from "./errors";
import type { LiveLink, LiveListener, LivePicture, PictureRequest } from "./live_link";
import { cameraOf, type View } from "./view";

/** The part of a WebSocket that is used. */
export type Socket = Pick<WebSocket, "send" | "close" | "binaryType" | "onopen" | "onclose" | "onmessage">;

/** Wait before a lost connection is opened again, ms; it doubles each time, up to the most. */
const RETRY_MS = { first: 500, most: 15_000 };
/** Close of a connection whose place another client has taken (1013, try again later, in the registry of IANA). */
const PLACE_TAKEN = 1013;
/** Least time between two times that the others are told where this one looks, ms. */
const LOOK_MS = 250;
/** Requests without an answer that may be sent before the link is busy. */
const MOST_UNANSWERED = 2;

export interface LiveSocketOptions {
  /** Resolves once a lost connection may be opened again: a socket is not told why it is refused. */
  readonly admitted: () => Promise<unknown>;
  readonly connect?: (address: string) => Socket;
}

export class LiveSocket implements LiveLink {
  readonly #address: string;
  readonly #view: View;
  readonly #listener: LiveListener;
  readonly #options: LiveSocketOptions;
  #socket: Socket | null = null;
  #isOpen = false;
  #isClosed = false;
  #retry: ReturnType<typeof setTimeout> | undefined;
  #waitMs = RETRY_MS.first;
  /** By id; those whose pictures may still arrive. */
  readonly #requests = new Map<number, PictureRequest>();
  /** Id of the newest request. */
  #newest = 0;
  /** Id of the newest request with an answer. */
  #answered = 0;
  /** Where this one looks, which is still to be told. */
  #look: number | null = null;
  #lookTimer: ReturnType<typeof setTimeout> | undefined;

  constructor(address: string, view: View, listener: LiveListener, options: LiveSocketOptions) {
    [this.#address, this.#view, this.#listener, this.#options] = [address, view, listener, options];
    this.#open();
  }

  get free(): boolean {
    return this.#newest - this.#answered < MOST_UNANSWERED;
  }

  request(request: PictureRequest): void {
    this.#newest += 1;
    this.#requests.set(this.#newest, request);
    this.#look = null; // the request tells it
    if (this.#isOpen) this.#send(this.#newest, request);
  }

  look(time: number): void {
    this.#look = time;
    if (this.#lookTimer === undefined) this.#tellLook();
  }

  /** Tells where this one looks, and later again where that has changed. */
  #tellLook(): void {
    const time = this.#look;
    if (time === null || !this.#isOpen) return;
    this.#look = null;
    const message: Json["LiveHere"] = { here: { camera: this.#view.camera, time } };
    this.#socket?.send(JSON.stringify(message));
    this.#lookTimer = setTimeout(() => {
      this.#lookTimer = undefined;
      this.#tellLook();
    }, LOOK_MS);
  }

  cancel(): void {
    if (this.#requests.size === 0) return;
    this.#requests.clear();
    this.#answered = this.#newest;
    if (this.#isOpen) this.#socket?.send(JSON.stringify({ stop: true } satisfies Json["LiveStop"]));
  }

  close(): void {
    this.#isClosed = true;
    clearTimeout(this.#retry);
    clearTimeout(this.#lookTimer);
    this.#requests.clear();
    this.#socket?.close();
  }

  #open(): void {
    const socket = this.#options.connect?.(this.#address) ?? new WebSocket(this.#address);
    this.#socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.#isOpen = true;
      this.#waitMs = RETRY_MS.first;
      const newest = this.#requests.get(this.#newest);
      if (newest) this.#send(this.#newest, newest);
      if (this.#lookTimer === undefined) this.#tellLook();
      this.#listener.onOpen(true);
    };
    socket.onmessage = ({ data }) => {
      if (!this.#isClosed) this.#receive(data);
    };
    socket.onclose = ({ code }) => {
      this.#isOpen = false;
      if (this.#isClosed) return;
      this.#requests.clear();
      this.#answered = this.#newest;
      this.#listener.onOthers?.([]);
      if (code === PLACE_TAKEN) this.#listener.onError(placeTaken());
      this.#listener.onOpen(false);
      this.#openLater();
    };
  }

  #openLater(): void {
    this.#retry = setTimeout(() => void this.#openAgain(), this.#waitMs);
    this.#waitMs = Math.min(2 * this.#waitMs, RETRY_MS.most);
  }

  async #openAgain(): Promise<void> {
    try {
      await this.#options.admitted();
    } catch (error) {
      const isRefused = error instanceof ServiceError && error.status === 401;
      if (!this.#isClosed && !isRefused) this.#openLater();
      return;
    }
    if (!this.#isClosed) this.#open();
  }

  #send(id: number, { time, quality, unsaved, moving, focusMaps }: PictureRequest): void {
    const { width, height, rays, layers, supersample, motion, motionBy } = quality;
    const message: Json["LiveRequest"] = {
      id,
      ...cameraOf(this.#view),
      ...{ time, width, height, rays, layers, supersample, motion, motionBy, moving, focusMaps },
      ...(unsaved.length > 0 && { changes: unsaved }),
    };
    this.#socket?.send(JSON.stringify(message));
  }

  #receive(data: unknown): void {
    if (data instanceof ArrayBuffer) {
      this.#receivePicture(data);
      return;
    }
    const message = JSON.parse(String(data)) as Json["LiveReadout"] | Json["LiveProblem"] | Json["LiveViewers"];
    if ("viewers" in message) {
      this.#listener.onOthers?.(othersOf(message));
      return;
    }
    const request = this.#answer(message.id);
    if (!("problem" in message)) {
      if (request) this.#listener.onReadout(toReadout(message.readout, message.points), request);
    } else if (message.id === null || (request && message.id === this.#newest)) {
      // A problem of a request before the newest matters to nobody.
      this.#listener.onError(errorOf(message.status, message.problem));
    }
  }

  #receivePicture(message: ArrayBuffer): void {
    const [head, data] = splitMessage(message);
    const request = this.#answer(head.id);
    const { stage, width, height, timing } = head;
    const end = data.byteLength - head.focusMapBytes;
    const blob = new Blob([data.slice(0, end)], { type: `image/${head.format}` });
    const focusMap = head.focusMapBytes > 0 ? data.slice(end) : null;
    const { rays, share, answeredMs: tookMs } = timing;
    const picture: LivePicture = { blob, stage, width, height, rays, share, tookMs, focusMap };
    const shown = request ? this.#listener.onPicture(picture, request) : Promise.resolve();
    const acknowledge = (): void => {
      if (this.#isOpen) this.#socket?.send(JSON.stringify({ ack: head.picture } satisfies Json["LiveAck"]));
    };
    void shown.then(acknowledge, acknowledge);
  }

  /** The request of an answer; those before it are dropped. */
  #answer(id: number | null): PictureRequest | undefined {
    if (id === null) return undefined;
    this.#answered = Math.max(this.#answered, id);
    for (const older of this.#requests.keys()) if (older < id) this.#requests.delete(older);
    return this.#requests.get(id);
  }
}

function placeTaken(): ServiceError {
  const detail = "Another viewer took this live connection. Until one is free, pictures follow a drag more slowly.";
  return new ServiceError({ code: "busy", detail }, 503);
}

/** Splits a message into head and picture: the length of the head, the head, the picture with its focus map. */
function splitMessage(message: ArrayBuffer): [Json["LivePictureHead"], ArrayBuffer] {
  const end = 4 + new DataView(message).getUint32(0);
  const head = new TextDecoder().decode(message.slice(4, end));
  return [JSON.parse(head) as Json["LivePictureHead"], message.slice(end)];
}

/**
 * Address of the live pictures of a shot.
 *
 * @param isSeen whether the others who look at the shot are seen, and see this one.
 */
export function liveAddress(base: string, shot: string, isSeen: boolean): string {
  const address = new URL(`/v1/shots/${encodeURIComponent(shot)}/live`, base);
  if (isSeen) address.searchParams.set("viewers", "true");
  address.protocol = address.protocol.replace("http", "ws");
  return address.href;
}
