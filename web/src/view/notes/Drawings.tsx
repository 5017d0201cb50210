/** Drawings of notes over the picture of their frame, and the sheet that the pointer draws on. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { pathOf } from "../../model/frame_notes";
import { followPointer } from "../hooks";

export function Drawings({ session }: { session: Session }): JSX.Element | null {
  const { frameNotes, playhead, pictures, aspect } = session;
  const shown = pictures.displayed.value?.time ?? playhead.time.value;
  const strokes = playhead.playing.value ? [] : frameNotes.strokesAt(shown);
  const isDrawing = frameNotes.drawsOn(shown);
  if (strokes.length === 0 && !isDrawing) return null;
  return (
    <svg
      class={isDrawing ? "drawings drawing-sheet" : "drawings"}
      viewBox={`0 0 ${aspect} 1`}
      preserveAspectRatio="none"
      aria-hidden="true"
      data-strokes={strokes.length}
      onPointerDown={(down) => {
        if (!isDrawing || down.button !== 0) return;
        down.preventDefault();
        draw(session, down);
      }}
    >
      {strokes.map((stroke, at) => (
        <path key={at} d={pathOf(stroke, aspect)} class={`ink-${stroke.colour}`} stroke-width={stroke.width} />
      ))}
    </svg>
  );
}

function draw({ frameNotes, aspect }: Session, down: PointerEvent): void {
  const sheet = (down.currentTarget as Element).getBoundingClientRect();
  const placeOf = ({ clientX, clientY }: PointerEvent): [number, number] => [
    (clientX - sheet.left) / sheet.width,
    (clientY - sheet.top) / sheet.height,
  ];
  frameNotes.penDown(placeOf(down), aspect);
  followPointer(
    down,
    (event) => {
      frameNotes.penTo(placeOf(event), aspect);
    },
    () => {
      frameNotes.penUp();
    },
  );
}
