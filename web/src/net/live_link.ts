/** Live pictures as the editor uses them. `net/live.ts` brings them over a WebSocket. */

import type { Changes } from "../model/changes";
import type { Quality } from "../model/quality";
import type { Readout } from "../model/shot";
import type { Other } from "../model/viewers";

export interface PictureRequest {
  readonly time: number;
  readonly quality: Quality;
  /** Changes that the picture shows and that are not saved. */
  readonly unsaved: Changes;
  /** While something moves one picture is enough, as the next request follows soon; else pictures improve up to the final one. */
  readonly moving: boolean;
  /** Whether the first picture and the final one come with a focus map. */
  readonly focusMaps: boolean;
}

export interface LivePicture {
  readonly blob: Blob;
  readonly stage: "preview" | "refining" | "final";
  readonly width: number;
  readonly height: number;
  /** Lens rays for each pixel; 0 where the picture was blurred instead. */
  readonly rays: number;
  /** Share of the final picture's work that is done. */
  readonly share: number;
  /** From the arrival of the request at the service to the picture, ms. */
  readonly tookMs: number;
  /** Its focus map, encoded; null where none came with it. */
  readonly focusMap: ArrayBuffer | null;
}

export interface LiveListener {
  /** Shows a picture; the promise resolves when it is on screen. */
  onPicture(picture: LivePicture, request: PictureRequest): Promise<void>;
  /** Takes the readout of the lens in the pictures of a request with unsaved changes. */
  onReadout(readout: Readout, request: PictureRequest): void;
  onError(error: unknown): void;
  /** Takes whether there is a connection; a lost one is opened again by the link. */
  onOpen(isOpen: boolean): void;
  /** Takes who else looks at the shot; left out, this connection sees nobody and is seen by nobody. */
  onOthers?(others: readonly Other[]): void;
}

export interface LiveLink {
  /** Whether another request would be served soon: playing waits for it. */
  readonly free: boolean;
  /** Requests a picture in place of the one before. Without a connection the newest request is sent once there is one. */
  request(request: PictureRequest): void;
  /** Tells the others where this one looks, where no picture is requested. */
  look(time: number): void;
  /** Cancels the requests, here and at the service; nothing arrives for them. */
  cancel(): void;
  close(): void;
}
