/** The picture on all of the screen. */

import { signal } from "@preact/signals";

const full = signal(false);

if (typeof document !== "undefined")
  document.addEventListener("fullscreenchange", () => {
    full.value = document.fullscreenElement !== null;
  });

export function isFullScreen(): boolean {
  return full.value;
}

/** Reason why the browser shows nothing on all of the screen; null where it does. */
export function fullScreenRefusal(): string | null {
  return typeof document !== "undefined" && document.fullscreenEnabled
    ? null
    : "This browser shows no part of a page on all of the screen.";
}

/** Shows the viewer on all of the screen, or no longer. A browser that refuses it leaves the page as it is. */
export async function toggleFullScreen(): Promise<void> {
  try {
    if (document.fullscreenElement) await document.exitFullscreen();
    else await document.querySelector(".viewer")?.requestFullscreen();
  } catch {
    // It says so itself.
  }
}
