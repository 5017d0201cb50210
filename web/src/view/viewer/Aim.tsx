/** The crosshair, with which the keyboard points at things in the picture: Tab comes to it, the arrow keys move it. */

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Session } from "../../editor/session";

export function Aim({ session: { crosshair, picks, document: edited } }: { session: Session }): JSX.Element {
  const place = useRef<HTMLDivElement>(null);
  const isHeld = crosshair.isHeld.value;
  useEffect(() => {
    if (isHeld) place.current?.focus();
  }, [isHeld]);
  useEffect(() => {
    // Another session has come in while the keyboard was here.
    if (document.activeElement === place.current) crosshair.hold();
    return () => {
      crosshair.letGo();
    };
  }, [crosshair]);
  const [x, y] = crosshair.at.value ?? [0.5, 0.5];
  const canEdit = edited.noEdits.value === null && edited.hasLens;
  return (
    <div
      ref={place}
      class="aim"
      tabIndex={0}
      role="application"
      aria-roledescription="crosshair"
      aria-label={`Crosshair on the picture: the arrow keys move it, with Shift ten times as far${canEdit ? ", Enter clicks" : ""}`}
      onFocus={() => {
        crosshair.hold();
      }}
      onBlur={() => {
        crosshair.letGo();
      }}
      onKeyDown={(event) => {
        if (event.key === "Enter" && isHeld) {
          if (!event.repeat) void picks.click([x, y], picks.toolWith(event));
        } else if (event.key === "Escape") place.current?.blur();
        else if (event.ctrlKey || event.altKey || !crosshair.move(event.key, event.shiftKey)) return;
        event.preventDefault();
      }}
    >
      {isHeld && (
        <>
          <i class="cross" style={{ left: `${100 * x}%`, top: `${100 * y}%` }} />
          <span class="visually-hidden" role="status">
            {Math.round(100 * x)} % from the left, {Math.round(100 * y)} % from the top
          </span>
        </>
      )}
    </div>
  );
}
