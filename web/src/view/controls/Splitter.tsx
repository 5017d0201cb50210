/** The edge of a panel: drag it or use the arrow keys to resize the panel; a double click or Enter folds it. */

import type { JSX, RefObject } from "preact";
import { useRef } from "preact/hooks";
import { LIMITS_PX, type Foldable, type Layout } from "../../editor/layout";
import { followPointer } from "../hooks";

/** How far a press of an arrow key goes, px. */
const STEP_PX = 16;

interface SplitterProps {
  readonly layout: Layout;
  readonly panel: Foldable;
  readonly label: string;
  /** The element whose size it sets. */
  readonly of: RefObject<HTMLElement | null>;
}

/** The arrow key that makes a panel larger, and the one that makes it smaller. */
const GROWING: Readonly<Record<Foldable, readonly [string, string]>> = {
  shots: ["ArrowRight", "ArrowLeft"],
  settings: ["ArrowLeft", "ArrowRight"],
  curve: ["ArrowUp", "ArrowDown"],
};

export function Splitter({ layout, panel, label, of }: SplitterProps): JSX.Element {
  const edge = useRef<HTMLDivElement>(null);
  const isUpright = panel !== "curve";
  const [least, most] = LIMITS_PX[panel];
  const measure = (): number => {
    const frame = of.current?.getBoundingClientRect();
    return (isUpright ? frame?.width : frame?.height) ?? least;
  };
  return (
    <div
      ref={edge}
      class={`splitter of-${panel}`}
      role="separator"
      tabIndex={0}
      aria-label={label}
      aria-orientation={isUpright ? "vertical" : "horizontal"}
      aria-valuemin={least}
      aria-valuemax={most}
      aria-valuenow={layout.sizes[panel].value || Math.round(measure())}
      title={`${label}: drag it; a double click folds it`}
      onDblClick={() => {
        layout.show(panel, false);
      }}
      onPointerDown={(down) => {
        if (down.button !== 0) return;
        down.preventDefault();
        const before = measure();
        const way = panel === "shots" ? 1 : -1;
        followPointer(
          down,
          (event) => {
            const gone = isUpright ? event.clientX - down.clientX : event.clientY - down.clientY;
            layout.resize(panel, before + way * gone);
          },
          () => undefined,
        );
      }}
      onKeyDown={(event) => {
        const [larger, smaller] = GROWING[panel];
        if (event.key === "Enter") {
          layout.show(panel, false);
          document.querySelector<HTMLElement>(`.panels .of-${panel}`)?.focus(); // which shows it again
        } else if (event.key === larger) layout.resize(panel, measure() + STEP_PX);
        else if (event.key === smaller) layout.resize(panel, measure() - STEP_PX);
        else if (event.key === "Home") layout.resize(panel, least);
        else if (event.key === "End") layout.resize(panel, most);
        else return;
        event.preventDefault();
      }}
    />
  );
}
