/** The place of the picture in its surround: as large as fits, or enlarged, with its edges on device pixels. */

import type { ComponentChildren, JSX } from "preact";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import type { Session } from "../../editor/session";
import { deliveredSize, type PictureBox } from "../../model/quality";
import { placed, type Box, type Room } from "../../model/zoom";
import { usePixelRatio, useSize } from "../hooks";
import { useCameraGestures } from "./camera_gestures";
import { useZoomGestures } from "./zoom_gestures";

/** Rest of the layout before its picture is asked for: each size costs the service a picture, ms. */
const SETTLE_MS = 60;

interface FrameProps {
  /** Width over height of the picture. */
  readonly aspect: number;
  readonly children: ComponentChildren;
}

interface SessionFrameProps extends FrameProps {
  readonly session: Session;
  /** Width of delivered pictures, px. */
  readonly deliveredPx: number;
  readonly onPointerMove: (event: PointerEvent) => void;
  readonly onPointerLeave: () => void;
  /** What lies in the surround, outside of the picture. */
  readonly beside: ComponentChildren;
}

/** A place for a picture that is shown as a whole. */
export function Frame({ aspect, children }: FrameProps): JSX.Element {
  const surround = useRef<HTMLDivElement>(null);
  const size = useSize(surround);
  const ratio = usePixelRatio();
  const box = placed({ ...size, ratio, aspect, deliveredPx: 1 }, null);
  return (
    <div class="surround" ref={surround}>
      <div class="picture" style={styleOf(box)}>
        {children}
      </div>
    </div>
  );
}

/** The place of the picture of an open shot, which can be enlarged. */
export function ZoomedFrame(props: SessionFrameProps): JSX.Element {
  const { session, aspect, deliveredPx, onPointerMove, onPointerLeave, children, beside } = props;
  const surround = useRef<HTMLDivElement>(null);
  const size = useSize(surround);
  const ratio = usePixelRatio();
  const placing = session.zoom.placing.value;
  const room: Room = { ...size, ratio, aspect, deliveredPx };
  const box = placed(room, placing);
  useLayoutEffect(() => {
    session.zoom.room = room;
  });
  useCameraGestures(surround, session); // before those that would take its drags
  useZoomGestures(surround, session);
  const scale = placing?.scale ?? null;
  useWantedSize(session, room, box.width, box.height, scale !== null);
  return (
    <div class={scale === null ? "surround" : "surround zoomed"} ref={surround} data-scale={scale}>
      <div
        class={scale !== null && scale >= 2 ? "picture coarse" : "picture"}
        style={styleOf(box)}
        onPointerMove={onPointerMove}
        onPointerLeave={onPointerLeave}
      >
        {children}
      </div>
      {beside}
    </div>
  );
}

/** Tells the session how many pixels the picture is to have, once that stays. */
function useWantedSize(session: Session, room: Room, widthPx: number, heightPx: number, isDelivered: boolean): void {
  const whole = deliveredSize(room.deliveredPx, room.aspect);
  const width = isDelivered ? whole.width : Math.round(widthPx * room.ratio);
  const height = isDelivered ? whole.height : Math.round(heightPx * room.ratio);
  useEffect(() => {
    if (width <= 0 || height <= 0) return undefined;
    const timer = setTimeout(() => {
      const box: PictureBox = { width, height, isDelivered };
      session.box.value = box;
    }, SETTLE_MS);
    return () => {
      clearTimeout(timer);
    };
  }, [session, width, height, isDelivered]);
}

function styleOf({ left, top, width, height }: Box): Record<keyof Box, string> {
  return { left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px` };
}
