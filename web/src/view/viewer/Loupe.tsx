/** A glass over the picture: it shows what is under the pointer or the crosshair, larger and pixel by pixel. */

import { effect } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Displayed } from "../../editor/pictures";
import type { Place } from "../../editor/picks";
import type { Session } from "../../editor/session";

/** Width of the glass, CSS px: that of the style sheet. */
const WIDTH_PX = 200;
/** Pixels on screen for each pixel of the picture, beyond those that it has already. */
const FACTOR = 4;

export function Loupe({ session }: { session: Session }): JSX.Element | null {
  const at = session.probed.value;
  const shown = session.pictures.displayed.value;
  if (!session.zoom.loupe.value || at === null || shown === null) return null;
  return <Glass session={session} at={at} />;
}

function Glass({ session, at: [x, y] }: { session: Session; at: Place }): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(
    () =>
      effect(() => {
        const [at, shown] = [session.probed.value, session.pictures.displayed.value];
        if (canvas.current && at && shown) paint(canvas.current, shown, at);
      }),
    [session],
  );
  return (
    <div class="loupe" style={{ left: `${100 * x}%`, top: `${100 * y}%` }} role="img" aria-label="Loupe">
      <canvas ref={canvas} aria-hidden="true" />
    </div>
  );
}

function paint(canvas: HTMLCanvasElement, { bitmap }: Displayed, [x, y]: Place): void {
  const side = Math.round(WIDTH_PX * devicePixelRatio);
  if (canvas.width !== side) [canvas.width, canvas.height] = [side, side];
  const context = canvas.getContext("2d", { alpha: false });
  const frame = canvas.closest(".picture")?.getBoundingClientRect();
  if (!context || !frame) return;
  const scale = FACTOR * Math.max(1, (frame.width * devicePixelRatio) / bitmap.width);
  const [width, height] = [bitmap.width * scale, bitmap.height * scale];
  context.imageSmoothingEnabled = false;
  context.fillStyle = "#000000";
  context.fillRect(0, 0, side, side);
  context.drawImage(bitmap, side / 2 - x * width, side / 2 - y * height, width, height);
}
