/**
 * A lane of keys for each setting and focus point that has any. A click on a key selects it and goes there, a drag moves the
 * selected keys in time; a drag beside the keys selects those in a box.
 */

import type { JSX } from "preact";
import { useRef, useState } from "preact/hooks";
import type { Session } from "../../editor/session";
import { labelOf, type KeyLane, type KeyStack, type OwnedKey } from "../../model/key_lanes";
import { isOfPlace, runsOf } from "../../model/key_runs";
import { formatFrame, sameTime } from "../../model/time";
import { followPointer } from "../hooks";
import { SNAP_PX, useKeyGestures } from "./key_gestures";
import { focusMoved, goToNext } from "./key_steps";
import { KeyRun } from "./KeyRun";
import type { TimeAxis } from "./time_axis";

interface Box {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

export function KeyLanes({ session, axis }: { session: Session; axis: TimeAxis }): JSX.Element {
  const lanes = session.keys.lanes.value;
  const list = useRef<HTMLDivElement>(null);
  const [box, setBox] = useState<Box | null>(null);
  return (
    <div
      class="lanes"
      role="group"
      aria-label="Keys"
      ref={list}
      onPointerDown={(event) => {
        const isOnButton = event.target instanceof Element && event.target.closest("button") !== null;
        const isOnScrollbar =
          event.clientX > (list.current?.getBoundingClientRect().left ?? 0) + event.currentTarget.clientWidth;
        if (event.button !== 0 || isOnButton || isOnScrollbar) return;
        if (list.current) selectInBox(session, axis, event, list.current, setBox);
      }}
    >
      {lanes.length === 0 && (
        <p class="lane-hint muted" style={{ left: `${axis.left}px` }}>
          Keys of focus points and of the camera show here.
        </p>
      )}
      {lanes.map((lane) => (
        <Lane key={lane.id} session={session} axis={axis} lane={lane} />
      ))}
      {box && (
        <div
          class="lane-box"
          style={{
            left: `${box.left}px`,
            top: `${box.top}px`,
            width: `${box.right - box.left}px`,
            height: `${box.bottom - box.top}px`,
          }}
        />
      )}
    </div>
  );
}

/** Selects the keys in the box that a pointer draws; none where it only clicks. */
function selectInBox(
  session: Session,
  axis: TimeAxis,
  down: PointerEvent,
  list: HTMLDivElement,
  show: (box: Box | null) => void,
): void {
  const place = (event: PointerEvent): readonly [number, number] => {
    const frame = list.getBoundingClientRect();
    return [event.clientX - frame.left, event.clientY - frame.top + list.scrollTop];
  };
  const [fromX, fromY] = place(down);
  const boxTo = (event: PointerEvent): Box => {
    const [x, y] = place(event);
    return { left: Math.min(x, fromX), top: Math.min(y, fromY), right: Math.max(x, fromX), bottom: Math.max(y, fromY) };
  };
  followPointer(
    down,
    (event) => {
      show(boxTo(event));
    },
    (event) => {
      show(null);
      if (event.type !== "pointerup") return;
      const box = boxTo(event);
      const top = list.getBoundingClientRect().top - list.scrollTop;
      const lanes = new Set(
        [...list.querySelectorAll<HTMLElement>("[data-lane]")]
          .filter((lane) => {
            const frame = lane.getBoundingClientRect();
            const y = (frame.top + frame.bottom) / 2 - top;
            return y >= box.top && y <= box.bottom;
          })
          .map((lane) => lane.dataset.lane),
      );
      const isInside = (stack: KeyStack): boolean => {
        const { time } = session.keys.shownAs(stack);
        return axis.has(time) && axis.x(time) >= box.left && axis.x(time) <= box.right;
      };
      const stacks = session.keys.lanes.value
        .filter(({ id }) => lanes.has(id))
        .flatMap((lane) => lane.stacks.filter(isInside));
      session.keys.select(stacks, down.shiftKey || session.touch.several.value);
    },
  );
}

function Lane({ session, axis, lane }: { session: Session; axis: TimeAxis; lane: KeyLane }): JSX.Element {
  const isSelected = lane.point !== null && session.selected.value === lane.point;
  const selected = session.keys.selected.value;
  const shown = lane.stacks.filter((stack) => axis.has(session.keys.shownAs(stack).time));
  const entry = shown.find(({ id }) => selected.has(id)) ?? shown[0];
  // A camera is often keyed at each frame, and its keys have no more than their times.
  const isCamera = isOfPlace(lane);
  const near = lane.stacks.filter((stack) => axis.has(stack.time) || shown.includes(stack)); // one that is dragged out stays
  const runs = isCamera ? runsOf(near, ROOM_PX / axis.perFrame) : lane.stacks.map((stack) => [stack]);
  return (
    <div
      class={isSelected ? "lane selected" : "lane"}
      data-lane={lane.id}
      data-color={lane.point === null ? undefined : session.pointColors.value.get(lane.point)}
    >
      <button
        type="button"
        class="lane-name"
        title={lane.label}
        aria-pressed={lane.point === null ? undefined : isSelected}
        onClick={() => {
          if (lane.point === null) session.keys.select(lane.stacks);
          else session.selected.value = lane.point;
        }}
      >
        {lane.label}
      </button>
      <div class="lane-line" style={{ left: `${axis.left}px`, width: `${axis.right - axis.left}px` }} />
      {runs.map((run, place) => {
        const [stack] = run;
        const isEntry = run.some((each) => each === entry);
        const key = isCamera ? stack?.id : place; // its keys come and go as the timeline is moved
        if (run.length > 1) return <KeyRun key={key} {...{ session, axis, lane, run, isEntry }} />;
        return stack && <StackKey key={key} {...{ session, axis, lane, stack, isEntry }} />;
      })}
    </div>
  );
}

/** Width of a key, px: where others are closer, a pointer cannot tell them apart. */
const ROOM_PX = 24;

interface StackKeyProps {
  readonly session: Session;
  readonly axis: TimeAxis;
  readonly lane: KeyLane;
  readonly stack: KeyStack;
  /** Whether Tab comes to it; from there `,` and `.` go on. */
  readonly isEntry: boolean;
}

function StackKey({ session, axis, lane, stack, isEntry }: StackKeyProps): JSX.Element {
  const { keys, playhead } = session;
  const button = useRef<HTMLButtonElement>(null);
  const gestures = useKeyGestures(session, {
    stack,
    isRaised: false,
    dragged: ({ right, isFree }) => ({ by: right / axis.perFrame, reach: isFree ? null : SNAP_PX / axis.perFrame }),
    nudged: ({ right }) => ({ by: right, reach: null }),
    click: (adds) => {
      keys.select([stack], adds);
      if (!adds) playhead.goTo(keys.shownAs(stack).time);
    },
    arrived: (at) => {
      focusMoved(button.current, lane, at);
    },
  });
  const isSelected = keys.selected.value.has(stack.id);
  const { time, keys: shown } = keys.shownAs(stack);
  const says = shown.map(inWords).join("; ");
  const isZero = stack.keys.every(({ key }) => key.value === 0);
  const isEnabled = stack.keys.every(({ owner }) => "attribute" in owner && owner.attribute === "enabled");
  const classes = ["lane-key", isEnabled && "enabled", isZero && "zero", isSelected && "selected"];
  if (sameTime(time, playhead.time.value)) classes.push("now");
  if (!axis.has(time)) classes.push("out");
  return (
    <button
      type="button"
      data-stack={stack.id}
      tabIndex={isEntry ? 0 : -1}
      class={classes.filter(Boolean).join(" ")}
      style={{ left: `${axis.x(time)}px` }}
      aria-pressed={isSelected}
      aria-label={`At frame ${formatFrame(time)}, ${lane.label}: ${says}`}
      title={`${formatFrame(time)}: ${says}`}
      ref={button}
      onPointerDown={gestures.onPointerDown}
      onKeyDown={(event) => {
        if (gestures.onKeyDown(event) || goToNext(session, lane, stack, event)) event.preventDefault();
      }}
      onKeyUp={gestures.onKeyUp}
      onBlur={gestures.onBlur}
      onClick={(event) => {
        if (event.detail > 0) return; // a pointer's, which `useKeyGestures` sees
        keys.select([stack], event.shiftKey);
        if (!event.shiftKey) playhead.goTo(stack.time);
      }}
    />
  );
}

function inWords({ owner, key }: OwnedKey): string {
  if ("place" in owner) return key.value === 1 ? "of the edits" : "of the shot";
  return `${labelOf(owner)} ${Number(key.value.toFixed(2)).toString()}, ${key.interpolation}`;
}
