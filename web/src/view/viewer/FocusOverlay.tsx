/** How sharp things are, drawn over the picture: peaking, false colour, and lines where the focus and its limits lie. */

import { effect } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { gateWidthMm } from "../../model/focus_map";
import { stopsToHold } from "../../model/sharpness";
import { limitOf } from "../sharp_limit";
import { FocusPainter } from "./focus_painter";

/** Whether anything is drawn over the picture. */
export function hasOverlay({ remembered }: Editor): boolean {
  return remembered.look.value !== "none" || remembered.focusLines.value === "on";
}

/** Asks for as many focus maps as the overlay and the probe need. */
export function useFocusMaps(editor: Editor, session: Session): void {
  const wanted = hasOverlay(editor) ? "all" : editor.remembered.probe.value === "on" ? "final" : "none";
  useLayoutEffect(() => {
    session.focusMaps.value = wanted;
  }, [session, wanted]);
}

export function FocusOverlay({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [isPossible, setPossible] = useState(true);
  useEffect(() => {
    if (!canvas.current) return undefined;
    const painter = FocusPainter.on(canvas.current);
    if (!painter) {
      setPossible(false);
      return undefined;
    }
    return effect(() => {
      paint(painter, editor, session);
    });
  }, [editor, session]);
  const shown = session.pictures.displayed.value;
  const hasMap = shown !== null && shown.focusMap !== null;
  return (
    <>
      <canvas
        ref={canvas}
        class="sharpness"
        aria-hidden="true"
        data-look={editor.remembered.look.value}
        data-painted={hasMap ? shown.stage : undefined}
      />
      {isPossible ? <Legend editor={editor} session={session} /> : <p class="wanted">This browser has no WebGL 2.</p>}
    </>
  );
}

function paint(painter: FocusPainter, editor: Editor, session: Session): void {
  const shown = session.pictures.displayed.value;
  const limitMm = limitOf(editor, session);
  const { look, focusLines } = editor.remembered;
  if (painter.isLost) return;
  if (!shown?.focusMap || limitMm === null) {
    painter.clear();
    return;
  }
  const { focusMap: map, bitmap, quality } = shown;
  const [width, height] = [quality.width, quality.height];
  painter.paint({ map, bitmap, look: look.value, lines: focusLines.value === "on", limitMm, width, height });
}

const STEPS = [8, 6, 4, 2];

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
      {look.value === "peaking" && <span class="swatch-peak">sharp</span>}
      {look.value === "falseColour" && (
        <span class="bar" title="Stops that the lens would have to be closed by">
          <span>in front</span>
          {STEPS.map((stops, at) => (
            <i key={stops} class={`near n${4 - at}`} />
          ))}
          <i class="mid" />
          {STEPS.map((stops, at) => (
            <i key={stops} class={`far f${at + 1}`} />
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
        up to {limitMm.toFixed(3)} mm, {px.toFixed(1)} px of {delivery.value}
      </span>
    </div>
  );
}

/** Stops by which a thing is sharp or not, in words. */
export function stopsInWords(cocMm: number, limitMm: number): string {
  const stops = stopsToHold(cocMm, limitMm);
  if (stops > 0) return `${stops.toFixed(1)} stops too soft`;
  return stops > -12 ? `sharp, ${(-stops).toFixed(1)} stops in hand` : "sharp";
}
