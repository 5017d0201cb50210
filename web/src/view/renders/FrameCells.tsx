/** Frames as small cells by their state; one of them is chosen by a click or by the arrow keys. */

import type { JSX } from "preact";
import { useEffect, useId, useRef } from "preact/hooks";
import type { FrameGroup } from "../../model/renders";

interface FrameCellsProps {
  readonly label: string;
  readonly groups: readonly FrameGroup[];
  readonly chosen: FrameGroup | null;
  readonly onChoose: (group: FrameGroup) => void;
}

export function FrameCells({ label, groups, chosen, onChoose }: FrameCellsProps): JSX.Element {
  const list = useRef<HTMLUListElement>(null);
  const id = useId();
  const at = groups.findIndex(({ tasks }) => tasks[0]?.frame === chosen?.tasks[0]?.frame);
  useEffect(() => {
    list.current?.children[at]?.scrollIntoView({ block: "nearest" });
  }, [at]);
  return (
    <ul
      ref={list}
      class="frame-cells"
      role="listbox"
      tabIndex={0}
      aria-label={label}
      aria-activedescendant={at < 0 ? undefined : `${id}-${at}`}
      onKeyDown={(event) => {
        const next = placeAfter(event.key, at, groups.length, columnsOf(list.current));
        const group = next === null ? undefined : groups[next];
        if (!group) return;
        event.preventDefault();
        onChoose(group);
      }}
    >
      {groups.map((group, place) => (
        <li
          key={group.tasks[0]?.frame}
          id={`${id}-${place}`}
          role="option"
          class={`frame-cell is-${group.state}`}
          aria-selected={place === at}
          aria-label={group.label}
          title={group.label}
          onClick={() => {
            onChoose(group);
          }}
        />
      ))}
    </ul>
  );
}

/** Cells in a row, as they are laid out. */
function columnsOf(list: HTMLElement | null): number {
  const cells = [...(list?.children ?? [])].filter((cell) => cell instanceof HTMLElement);
  const next = cells.findIndex(({ offsetTop }) => offsetTop !== cells[0]?.offsetTop);
  return next < 0 ? cells.length : next;
}

/** The place that a key goes to; null for another key. */
function placeAfter(key: string, at: number, count: number, columns: number): number | null {
  const steps: Readonly<Record<string, number>> = {
    ArrowLeft: -1,
    ArrowRight: 1,
    ArrowUp: -columns,
    ArrowDown: columns,
    Home: -count,
    End: count,
  };
  const step = steps[key];
  if (step === undefined) return null;
  return at < 0 ? (key === "End" ? count - 1 : 0) : Math.min(Math.max(at + step, 0), count - 1);
}
