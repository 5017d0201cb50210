/** The other picture over the present one: beside a divider, as their difference, or one after the other. */

import { effect } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Comparison } from "../../editor/comparison";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { saidOtherwise } from "../../model/comparison";
import { followPointer } from "../hooks";

/** How long each picture is shown, ms: less than three changes a second. */
const FLICKER_MS = 500;
/** Part of the width that a press of an arrow key goes, and with Shift. */
const STEP = 0.01;
const LEAP = 0.1;

export function Compare({ editor, session }: { editor: Editor; session: Session }): JSX.Element | null {
  const { comparison } = session;
  useFlicker(comparison);
  const mode = comparison.mode.value;
  if (mode === "off") return null;
  return (
    <>
      {comparison.other.value && <Other session={session} />}
      {mode === "wipe" && <Divider comparison={comparison} />}
      <Said editor={editor} comparison={comparison} />
    </>
  );
}

/** Shows one picture after the other, unless less motion is wanted: then a key does it alone. */
function useFlicker({ mode, showsOther }: Comparison): void {
  const isOn = mode.value === "flicker";
  useEffect(() => {
    if (!isOn || matchMedia("(prefers-reduced-motion: reduce)").matches) return undefined;
    const timer = setInterval(() => (showsOther.value = !showsOther.value), FLICKER_MS);
    return () => {
      clearInterval(timer);
    };
  }, [isOn, showsOther]);
}

function Other({ session }: { session: Session }): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  const { comparison } = session;
  useEffect(
    () =>
      effect(() => {
        if (canvas.current) paint(canvas.current, session);
      }),
    [session],
  );
  const mode = comparison.mode.value;
  const divider = `${100 * comparison.divider.value}%`;
  return (
    <canvas
      ref={canvas}
      class="compared"
      aria-hidden="true"
      data-mode={mode}
      data-best={comparison.isBest.value}
      hidden={mode === "flicker" && !comparison.showsOther.value}
      style={{ clipPath: mode === "wipe" ? `inset(0 0 0 ${divider})` : "none" }}
    />
  );
}

function paint(canvas: HTMLCanvasElement, { comparison, pictures }: Session): void {
  const [shown, other] = [pictures.displayed.value, comparison.other.value];
  const [mode, gain] = [comparison.mode.value, Number(comparison.gain.value)];
  const context = canvas.getContext("2d", { alpha: false });
  if (!context || !shown || !other) return;
  const { width, height } = shown.quality;
  [canvas.width, canvas.height] = [width, height];
  context.imageSmoothingQuality = "high";
  if (mode === "difference") {
    context.drawImage(shown.bitmap, 0, 0, width, height);
    context.globalCompositeOperation = "difference";
  }
  // A camera of another shape is shown as a whole.
  const scale = Math.min(width / other.width, height / other.height);
  const isSame = Math.abs(other.width / other.height - width / height) < 0.01;
  const [wide, high] = isSame ? [width, height] : [other.width * scale, other.height * scale];
  context.drawImage(other, (width - wide) / 2, (height - high) / 2, wide, high);
  if (mode !== "difference") return;
  context.globalCompositeOperation = "lighter";
  for (let factor = 1; factor < gain; factor *= 2) context.drawImage(canvas, 0, 0);
}

/** The edge between both pictures: drag it, or use the arrow keys. */
function Divider({ comparison: { divider } }: { comparison: Comparison }): JSX.Element {
  const percent = Math.round(100 * divider.value);
  const go = (part: number): void => {
    divider.value = Math.min(Math.max(part, 0), 1);
  };
  return (
    <div
      class="divider"
      role="slider"
      tabIndex={0}
      aria-label="Divider between the present picture and the other one"
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={percent}
      aria-valuetext={`${percent} % of the width show the present picture`}
      style={{ left: `${100 * divider.value}%` }}
      onPointerDown={(down) => {
        const frame = down.currentTarget.closest(".picture")?.getBoundingClientRect();
        if (!frame || down.button !== 0) return;
        followPointer(
          down,
          ({ clientX }) => {
            go((clientX - frame.left) / frame.width);
          },
          () => undefined,
        );
      }}
      onKeyDown={(event) => {
        const by = event.shiftKey ? LEAP : STEP;
        if (event.key === "ArrowRight" || event.key === "ArrowUp") go(divider.value + by);
        else if (event.key === "ArrowLeft" || event.key === "ArrowDown") go(divider.value - by);
        else if (event.key === "Home") go(0);
        else if (event.key === "End") go(1);
        else return;
        event.preventDefault();
      }}
    />
  );
}

/** Which picture is which. */
function Said({ editor, comparison }: { editor: Editor; comparison: Comparison }): JSX.Element {
  const { mode, snapshot, otherwise, other, isBest, gain, showsOther } = comparison;
  const said = snapshot.value?.said ?? saidOtherwise(otherwise.value, editor.lenses.value);
  const state = other.value === null ? " comes with the best picture…" : isBest.value ? "" : " …";
  const both = mode.value === "wipe";
  return (
    <div class="compare-said" role="note">
      {both && <span>A: present</span>}
      {mode.value === "difference" && <span>{`Difference of display values, ${gain.value} times`}</span>}
      {mode.value === "flicker" && !showsOther.value && <span>A: present</span>}
      {(mode.value !== "flicker" || showsOther.value) && (
        <span class="of-other">
          B: {said}
          {state}
        </span>
      )}
    </div>
  );
}
