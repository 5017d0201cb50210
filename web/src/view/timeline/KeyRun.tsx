/**
 * Keys that are too close for a pointer to tell them apart: one button that shows them all. A click takes the nearest one, the
 * keyboard goes through them; zoomed in, each has a button of its own.
 */

import type { JSX } from "preact";
import { useRef } from "preact/hooks";
import type { Session } from "../../editor/session";
import type { KeyLane, KeyStack } from "../../model/key_lanes";
import { nearestOf } from "../../model/key_runs";
import { formatFrame } from "../../model/time";
import { SNAP_PX, useKeyGestures } from "./key_gestures";
import { focusMoved, goToNext } from "./key_steps";
import type { TimeAxis } from "./time_axis";

interface KeyRunProps {
  readonly session: Session;
  readonly axis: TimeAxis;
  readonly lane: KeyLane;
  /** Two stacks or more, in the order of time. */
  readonly run: readonly KeyStack[];
  /** Whether Tab comes to it. */
  readonly isEntry: boolean;
}

/** Half the height and width of a diamond, and half of the button's height, px. */
const [DIAMOND_PX, MIDDLE_PX] = [4, 12];

export function KeyRun({ session, axis, lane, run, isEntry }: KeyRunProps): JSX.Element {
  const { keys, playhead } = session;
  const button = useRef<HTMLButtonElement>(null);
  const selected = keys.selected.value;
  const own = run.find(({ id }) => selected.has(id)) ?? nearestOf(run, playhead.time.value);
  const take = (stack: KeyStack, adds: boolean): void => {
    keys.select([stack], adds);
    if (!adds) playhead.goTo(stack.time);
  };
  const gestures = useKeyGestures(session, {
    stack: own,
    isRaised: false,
    dragged: ({ right, isFree }) => ({ by: right / axis.perFrame, reach: isFree ? null : SNAP_PX / axis.perFrame }),
    nudged: ({ right }) => ({ by: right, reach: null }),
    click: (adds) => {
      take(own, adds);
    },
    arrived: (at) => {
      focusMoved(button.current, lane, at);
    },
  });
  const [left, right] = [axis.x(run[0]?.time ?? 0) - MIDDLE_PX, axis.x(run.at(-1)?.time ?? 0) + MIDDLE_PX];
  const diamonds = (isDrawn: (stack: KeyStack) => boolean): string =>
    run
      .map((stack) => ({ stack, x: axis.x(keys.shownAs(stack).time) - left }))
      .filter(({ stack }) => isDrawn(stack))
      .map(({ x }) => `M${(x - DIAMOND_PX).toFixed(1)} ${MIDDLE_PX}l4 -4l4 4l-4 4Z`)
      .join("");
  const says = wordsOf(run);
  return (
    <button
      ref={button}
      type="button"
      class="lane-run"
      data-stack={own.id}
      data-run={run.length}
      tabIndex={isEntry ? 0 : -1}
      style={{ left: `${left}px`, width: `${right - left}px` }}
      aria-pressed={selected.has(own.id)}
      aria-label={`${lane.label}: ${says}; at frame ${formatFrame(own.time)}`}
      title={says}
      onKeyDown={(event) => {
        if (gestures.onKeyDown(event) || goToNext(session, lane, own, event)) event.preventDefault();
      }}
      onKeyUp={gestures.onKeyUp}
      onBlur={gestures.onBlur}
      onClick={(event) => {
        const x = event.clientX - event.currentTarget.getBoundingClientRect().left + left;
        take(event.detail > 0 ? nearestOf(run, axis.exactTime(x)) : own, event.shiftKey);
      }}
    >
      <svg width={right - left} height={2 * MIDDLE_PX} aria-hidden="true">
        <path class="hollow" d={diamonds((stack) => !isEdited(stack))} />
        <path d={diamonds(isEdited)} />
        <path class="chosen" d={diamonds(({ id }) => selected.has(id))} />
      </svg>
    </button>
  );
}

function isEdited({ keys }: KeyStack): boolean {
  return keys.some(({ key }) => key.value !== 0);
}

/** How many keys there are, from where to where, and of which layer. */
function wordsOf(run: readonly KeyStack[]): string {
  const edited = run.filter(isEdited).length;
  const [first, last] = [run[0]?.time ?? 0, run.at(-1)?.time ?? 0].map(formatFrame);
  const whose = edited === 0 ? "of the shot" : edited === run.length ? "of the edits" : `${edited} of the edits`;
  return `${run.length} keys, frames ${String(first)} to ${String(last)}, ${whose}`;
}
