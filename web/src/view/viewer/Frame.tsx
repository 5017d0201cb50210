/** The place of the picture in its surround: as large as fits, with its edges on device pixels. */

import type { ComponentChildren, JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { letterbox } from "../../model/quality";
import { usePixelRatio, useSize } from "../hooks";

/** Rest of the layout before its picture is asked for: each size costs the service a picture, ms. */
const SETTLE_MS = 60;

interface FrameProps {
  /** Width over height of the picture. */
  readonly aspect: number;
  /** Takes the size of the picture in device pixels, once it stays. */
  readonly onBox?: (box: { readonly width: number; readonly height: number }) => void;
  readonly onPointerMove?: (event: PointerEvent) => void;
  readonly onPointerLeave?: () => void;
  readonly children: ComponentChildren;
  /** What lies in the surround, outside of the picture. */
  readonly beside?: ComponentChildren;
}

export function Frame({ aspect, onBox, onPointerMove, onPointerLeave, children, beside }: FrameProps): JSX.Element {
  const surround = useRef<HTMLDivElement>(null);
  const size = useSize(surround);
  const ratio = usePixelRatio();
  const { left, top, width, height } = snapToPixels(letterbox(size.width, size.height, aspect), ratio);
  useEffect(() => {
    if (!onBox || width <= 0 || height <= 0) return undefined;
    const timer = setTimeout(onBox, SETTLE_MS, {
      width: Math.round(width * ratio),
      height: Math.round(height * ratio),
    });
    return () => {
      clearTimeout(timer);
    };
  }, [onBox, width, height, ratio]);
  const style = { left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px` };
  return (
    <div class="surround" ref={surround}>
      <div class="picture" style={style} onPointerMove={onPointerMove} onPointerLeave={onPointerLeave}>
        {children}
      </div>
      {beside}
    </div>
  );
}

/** Edges on device pixels, so that a picture of that many pixels is shown one to one. */
function snapToPixels<Box extends Record<"left" | "top" | "width" | "height", number>>(box: Box, ratio: number): Box {
  const snap = (value: number): number => Math.round(value * ratio) / ratio;
  const even = (value: number): number => (Math.floor((value * ratio) / 2) * 2) / ratio;
  return { ...box, left: snap(box.left), top: snap(box.top), width: even(box.width), height: even(box.height) };
}
