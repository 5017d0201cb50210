/** A lane of keys for each focus point that has any: click a key to go there. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import type { Key } from "../../model/keys";
import { KEYED_ATTRIBUTES, keysOf, type FocusPoint, type KeyedAttribute } from "../../model/shot";
import { formatFrame, sameTime } from "../../model/time";
import type { TimeAxis } from "./time_axis";

export function KeyLanes({ session, axis }: { session: Session; axis: TimeAxis }): JSX.Element {
  const points = session.document.points.value.filter((point) => keysOfPage(point).length > 0);
  return (
    <div class="lanes" role="group" aria-label="Keys of the focus points">
      {points.length === 0 && (
        <p class="lane-hint muted" style={{ left: `${axis.left}px` }}>
          The focus points’ keys show here.
        </p>
      )}
      {points.map((point) => (
        <Lane key={point.name} session={session} axis={axis} point={point} />
      ))}
    </div>
  );
}

function keysOfPage(point: FocusPoint): { attribute: KeyedAttribute; key: Key }[] {
  return KEYED_ATTRIBUTES.flatMap((attribute) => keysOf(point, attribute).map((key) => ({ attribute, key })));
}

function Lane({ session, axis, point }: { session: Session; axis: TimeAxis; point: FocusPoint }): JSX.Element {
  const selected = session.selected.value === point.name;
  const now = session.playhead.time.value;
  return (
    <div class={selected ? "lane selected" : "lane"}>
      <button
        type="button"
        class="lane-name"
        aria-pressed={selected}
        onClick={() => (session.selected.value = point.name)}
      >
        {point.name}
      </button>
      <div class="lane-line" style={{ left: `${axis.left}px`, width: `${axis.right - axis.left}px` }} />
      {keysOfPage(point).map(({ attribute, key }) => (
        <button
          key={`${attribute} ${key.time}`}
          type="button"
          tabIndex={-1}
          class={`lane-key ${attribute}${sameTime(key.time, now) ? " now" : ""}${key.value === 0 ? " zero" : ""}`}
          style={{ left: `${axis.x(key.time)}px` }}
          aria-label={`${attribute} of ${point.name} is ${key.value} at frame ${formatFrame(key.time)}`}
          title={`${attribute} ${Number(key.value.toFixed(2))} at ${formatFrame(key.time)}, ${key.interpolation}`}
          onClick={() => {
            session.selected.value = point.name;
            session.playhead.goTo(key.time);
          }}
        />
      ))}
    </div>
  );
}
