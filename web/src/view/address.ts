/** Shot, camera and time in the page's address, so that a link opens them. */

import { effect } from "@preact/signals";
import type { Editor } from "../editor/editor";

export interface Address {
  readonly shot: string | null;
  readonly camera: string | null;
  readonly time: number | null;
}

export function readAddress(href: string): Address {
  const query = new URL(href).searchParams;
  const time = Number(query.get("time") ?? NaN);
  return { shot: query.get("shot"), camera: query.get("camera"), time: Number.isFinite(time) ? time : null };
}

/** The address relative to the page; prim paths keep their slashes. */
export function writeAddress(address: Address | null): string {
  if (!address?.shot) return "?";
  const query = new URLSearchParams({ shot: address.shot });
  if (address.camera !== null) query.set("camera", address.camera);
  if (address.time !== null) query.set("time", address.time.toString());
  return `?${query.toString().replaceAll("%2F", "/")}`;
}

/** Writes the address whenever it changes; until a shot was open it says what is to be opened, and stays. */
export function followAddress({ session }: Pick<Editor, "session">, write: (address: string) => void): void {
  let hasOpened = false;
  effect(() => {
    const open = session.value;
    hasOpened ||= open !== null;
    // While playing it keeps still: browsers allow few changes of it in a second.
    if (!hasOpened || open?.playhead.playing.value || open?.playhead.scrubbing.value) return;
    write(writeAddress(open && { ...open.document.view, time: open.playhead.time.value }));
  });
}
