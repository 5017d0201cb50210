/** One line that says what sets the brightness; each value goes to the control that sets it. */

import type { JSX } from "preact";
import { useContext } from "preact/hooks";
import { brightnessOf, type Brightness, type Part } from "../../model/brightness";
import type { Photography } from "../../model/photography";
import { FoldedContext } from "./Section";

/** Sections that have what sets the brightness. */
const SECTIONS = ["exposure", "film", "glass"];

const HEADS: Readonly<Record<Brightness["by"], string>> = {
  meter: "Brightness: set by the light meter",
  camera: "Brightness:",
  scene: "Brightness: as the scene is lit",
};

export function BrightnessLine({ current }: { current: Photography }): JSX.Element {
  const { by, parts } = brightnessOf(current);
  return (
    <p class="brightness" data-by={by}>
      {HEADS[by]}
      {by === "scene" && parts.length === 0 && ". Nothing exposes the picture: USD’s exposure is 0"}
      {parts.map((part, at) => (
        <span key={part.text}>
          {at > 0 || by !== "camera" ? ", " : " "}
          <Value part={part} />
        </span>
      ))}
      .
    </p>
  );
}

function Value({ part: { text, setting } }: { part: Part }): JSX.Element {
  const folded = useContext(FoldedContext);
  if (setting === null) return <>{text}</>;
  return (
    <button
      type="button"
      class="link"
      onClick={() => {
        for (const name of SECTIONS) if (folded?.has(name)) folded.toggle(name);
        requestAnimationFrame(() => {
          focusControl(setting);
        });
      }}
    >
      {text}
    </button>
  );
}

/** Focuses the control of a setting, where the page shows one. */
function focusControl(setting: string): void {
  const place = document.querySelector(`[data-setting="${setting}"]`);
  const control =
    place?.querySelector<HTMLElement>("input.number") ??
    place?.querySelector<HTMLElement>("input, [aria-checked=true], select, button");
  control?.scrollIntoView({ block: "nearest" });
  control?.focus();
}
