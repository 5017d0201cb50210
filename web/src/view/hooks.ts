/** Small helpers of the view. */

import type { RefObject } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";

export interface Size {
  readonly width: number;
  readonly height: number;
}

/** The size of an element's content in CSS pixels, kept up to date. */
export function useSize(ref: RefObject<HTMLElement | null>): Size {
  const [size, setSize] = useState<Size>({ width: 0, height: 0 });
  useEffect(() => {
    const element = ref.current;
    if (!element) return;
    const observer = new ResizeObserver(([entry]) => {
      if (entry) setSize({ width: entry.contentRect.width, height: entry.contentRect.height });
    });
    observer.observe(element);
    return () => {
      observer.disconnect();
    };
  }, [ref]);
  return size;
}

/** Device pixels for each CSS pixel, kept up to date as the window goes from screen to screen. */
export function usePixelRatio(): number {
  const [ratio, setRatio] = useState(devicePixelRatio);
  useEffect(() => {
    const query = matchMedia(`(resolution: ${ratio.toString()}dppx)`);
    const changed = (): void => {
      setRatio(devicePixelRatio);
    };
    query.addEventListener("change", changed);
    return () => {
      query.removeEventListener("change", changed);
    };
  }, [ratio]);
  return ratio;
}

/** Hands a file to the browser's downloads. */
export function save({ blob, name }: { blob: Blob; name: string }): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}

/** Follows a pointer from where it went down until it is let go or its hold is taken away; what is returned ends that at once. */
export function followPointer(
  down: PointerEvent,
  onMove: (event: PointerEvent) => void,
  onEnd: (event: PointerEvent) => void,
): () => void {
  const element = down.currentTarget as Element;
  element.setPointerCapture(down.pointerId);
  const listening = new AbortController();
  const { signal } = listening;
  const end = (event: Event): void => {
    listening.abort();
    onEnd(event as PointerEvent);
  };
  element.addEventListener(
    "pointermove",
    (event) => {
      onMove(event as PointerEvent);
    },
    { signal },
  );
  element.addEventListener("pointerup", end, { signal });
  element.addEventListener("pointercancel", end, { signal });
  element.addEventListener("lostpointercapture", end, { signal });
  return () => {
    listening.abort();
  };
}

/** The element of a modal dialog, which is open while it is to be. */
export function useModal(isOpen: boolean): RefObject<HTMLDialogElement | null> {
  const ref = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    if (isOpen) ref.current?.showModal();
    else ref.current?.close();
  }, [isOpen]);
  return ref;
}
