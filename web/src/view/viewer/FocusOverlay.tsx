/** How sharp things are, drawn over the picture: peaking, false colour, and lines where the focus and its limits lie. */

import { effect } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { gateWidthMm } from "../../model/focus_map";
import { stopsToHold } from "../../model/sharpness";
import type { LivePicture } from "../../net/live_link";
import { limitOf } from "../sharp_limit";
import { FocusPainter } from "./focus_painter";

/** Whether anything is drawn over the picture. */
export function hasOverlay({ remembered }: Editor): boolean {
  return remembered.look.value !== "none" || remembered.focusLines.value === "on";
}

/** Asks for focus maps: with all pictures for the overlay, and for the probe that of the picture that the pointer or the crosshair is on. */
export function useFocusMaps(editor: Editor, session: Session): void {
  const isCovered = hasOverlay(editor);
  useLayoutEffect(() => {
    session.focusMaps.value = isCovered;
  }, [session, isCovered]);
  const isProbed = editor.remembered.probe.value === "on" && session.probed.value !== null && session.settled.value;
  useEffect(() => {
    if (isProbed) session.pictures.readMap();
  }, [session, isProbed]);
}

export function FocusOverlay({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [isPossible, setPossible] = useState(true);
  // A browser may take the context away when it wants memory; it gives a new one later.
  const [contexts, setContexts] = useState(1);
  useEffect(() => {
    const drawn = canvas.current;
    const painter = drawn && FocusPainter.on(drawn);
    setPossible(painter !== null);
    if (!painter) return undefined;
    const stop = effect(() => {
      const painted = paint(painter, editor, session);
      if (painted) drawn.dataset.painted = painted;
      else delete drawn.dataset.painted;
    });
    const stopListening = painter.onLost(() => {
      setContexts((count) => count + 1);
    });
    return () => {
      stop();
      stopListening();
      painter.release();
    };
  }, [editor, session, contexts]);
  return (
    <>
      <canvas
        key={contexts}
        ref={canvas}
        class="sharpness"
        aria-hidden="true"
        data-look={editor.remembered.look.value}
      />
      {isPossible ? <Legend editor={editor} session={session} /> : <p class="wanted">This browser has no WebGL 2.</p>}
    </>
  );
}

/** Paints over the picture that is displayed, and returns its stage; null where it has no focus map. */
function paint(painter: FocusPainter, editor: Editor, session: Session): LivePicture["stage"] | null {
  const shown = session.pictures.displayed.value;
  const limitMm = limitOf(editor, session);
  const { look, focusLines } = editor.remembered;
  if (!shown?.focusMap || limitMm === null) {
    painter.clear();
    return null;
  }
  const { focusMap: map, bitmap, quality } = shown;
  const [width, height] = [quality.width, quality.height];
  painter.paint({ map, bitmap, look: look.value, lines: focusLines.value === "on", limitMm, width, height });
  return shown.stage;
}

/** What the colours say. */
function Legend({ editor, session }: { editor: Editor; session: Session }): JSX.Element | null {
  const limitMm = limitOf(editor, session);
  const shown = session.pictures.displayed.value;
  const { look, focusLines, delivery } = editor.remembered;
  if (limitMm === null || !shown) return null;
  if (shown.focusMap === null) return <p class="focus-legend">Sharpness comes with the picture…</p>;
  const px = (limitMm / gateWidthMm(shown.focusMap)) * Number(delivery.value);
  return (
    <div class="focus-legend" role="note">
      {look.value === "peaking" && <span class="swatch-peak">in focus</span>}
      {look.value === "falseColour" && (
        <span class="bar">
          <span>in front</span>
          {[4, 3, 2, 1].map((step) => (
            <i key={step} class={`n${step}`} />
          ))}
          <i class="mid" />
          <span>sharp</span>
          <i class="mid" />
          {[1, 2, 3, 4].map((step) => (
            <i key={step} class={`f${step}`} />
          ))}
          <span>behind; a step is two stops</span>
        </span>
      )}
      {focusLines.value === "on" && (
        <>
          <span class="key-near">near limit</span> <span class="key-focus">focus</span>{" "}
          <span class="key-far">far limit</span>
        </>
      )}
      <span>
        sharp up to {limitMm.toFixed(3)} mm, {px.toFixed(1)} px of {delivery.value}
      </span>
    </div>
  );
}

/** Stops by which a thing is sharp or not, in words. */
export function stopsInWords(cocMm: number, limitMm: number): string {
  const stops = stopsToHold(cocMm, limitMm);
  if (stops > 0) return `${stops.toFixed(1)} stops too soft`;
  return stops > -12 ? `sharp, ${(-stops).toFixed(1)} stops to spare` : "sharp";
}
