/** Longest wait for a frame, ms: a page that is hidden draws none. */
const PATIENCE_MS = 50;

/** Resolves once the browser has drawn a frame, so that what begins then is not in the way of what a hand does. */
export function frameDrawn(): Promise<void> {
  if (typeof requestAnimationFrame === "undefined") return Promise.resolve();
  return new Promise((resolve) => {
    const timer = setTimeout(resolve, PATIENCE_MS);
    requestAnimationFrame(() => {
      clearTimeout(timer);
      setTimeout(resolve);
    });
  });
}
