/** Says which frame is on screen, where it is not the one that is wanted. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { formatFrame, sameTime } from "../../model/time";

/** Whether the picture on screen is that of another frame. While playing that is so for a moment with each frame. */
export function isLate({ pictures, playhead }: Session): boolean {
  const shown = pictures.displayed.value;
  return shown !== null && !playhead.playing.value && !sameTime(shown.time, playhead.time.value);
}

export function Wanted({ session }: { session: Session }): JSX.Element | null {
  const shown = session.pictures.displayed.value;
  if (shown === null || !isLate(session)) return null;
  return (
    <p class="wanted" role="status">
      Frame {formatFrame(shown.time)}, wanted {formatFrame(session.playhead.time.value)}
    </p>
  );
}
