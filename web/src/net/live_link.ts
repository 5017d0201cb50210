/** Live pictures as the editor uses them: what it asks for, and what it hears. `net/live.ts` brings them over a WebSocket. */

import type { Changes } from "../model/changes";
import type { Quality } from "../model/quality";
import type { Readout } from "../model/shot";

/** A picture that is wanted. */
export interface Wish {
  readonly time: number;
  readonly quality: Quality;
  /** Changes that are tried in it and not saved. */
  readonly tried: Changes;
  /** While a hand moves one picture will do, since the next is wanted soon; else they get better to the last. */
  readonly moving: boolean;
}

export interface LivePicture {
  readonly blob: Blob;
  readonly stage: "preview" | "refining" | "final";
  readonly width: number;
  readonly height: number;
  /** Lens rays for each pixel; 0 where it was blurred instead. */
  readonly rays: number;
  /** Share of the final picture's work that is done. */
  readonly share: number;
  /** From when the service had the request to when it had the picture. */
  readonly tookMs: number;
}

export interface LiveEar {
  /** A picture is there; the promise resolves when it was looked at. */
  onPicture(picture: LivePicture, wish: Wish): Promise<void>;
  /** What the lens does in the pictures of a wish that tries something. */
  onReadout(readout: Readout, wish: Wish): void;
  onError(error: unknown): void;
  /** The connection came to be, or is lost; it is tried again by itself. */
  onOpen(isOpen: boolean): void;
}

export interface LiveLink {
  /** Whether another wish would be looked at soon: what playing waits for. */
  readonly free: boolean;
  /** Asks for a picture, in place of what was wanted before. Where there is no connection it is forgotten. */
  want(wish: Wish): void;
  /** Gives up what was wanted, here and at the service: nothing is heard of it any more. */
  forget(): void;
  close(): void;
}
