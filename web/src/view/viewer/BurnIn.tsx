/** Facts about the picture on screen, written in its corners. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { burnIn, type Filmed, type TakenWith } from "../../model/burn_in";
import { sampleAt } from "../../model/curve";
import { primName } from "../../model/shot";
import { sameTime } from "../../model/time";

export function BurnIn({ editor, session }: { editor: Editor; session: Session }): JSX.Element | null {
  const { burnInShown, burnIn: chosen, unit } = editor.remembered;
  const shown = session.pictures.displayed.value;
  if (burnInShown.value === "off" || !shown) return null;
  const corners = burnIn(chosen.names, filmedAt(editor, session, shown.time), unit.value);
  return (
    <div class="burn-in" role="note" aria-label="Burn-ins" data-time={shown.time}>
      {corners.map(({ corner, lines }) => (
        <div key={corner} class={`burnt ${corner}`}>
          {lines.map((line, at) => (
            <span key={at}>{line}</span>
          ))}
        </div>
      ))}
    </div>
  );
}

/** What the picture of a time is of. */
function filmedAt(editor: Editor, session: Session, time: number): Filmed {
  return {
    shot: session.shot.name,
    camera: session.camera === null ? "framing camera" : primName(session.camera),
    time,
    framesPerSecond: session.shot.range.framesPerSecond,
    lens: lensAt(session, time),
    film: filmOf(editor, session),
    revision: session.document.history.value.revision,
    date: new Date(),
  };
}

/** The lens of the picture: of the curve while the playhead is elsewhere. */
function lensAt({ document, playhead, photography }: Session, time: number): TakenWith | null {
  const now = document.hasLens ? document.readout.value : null;
  if (!now) return null;
  const sample = sameTime(time, playhead.time.value) ? now : (sampleAt(document.curve.value, time) ?? now);
  const exposure = photography.current.value?.exposure;
  const { lensName, lensModel } = now;
  const { focalLengthMm, fStop, focusDistanceM } = sample;
  return {
    ...{ lensName, lensModel, focalLengthMm, focusDistanceM, stop: fStop },
    marking: exposure?.stopMarking ?? "f",
    transmittance: exposure?.transmittance ?? 1,
  };
}

function filmOf(editor: Editor, session: Session): string {
  const film = session.photography.current.value?.film;
  if (!film || film.process === "none") return "";
  if (film.process === "digital") return "digital";
  return editor.libraries.value.films.find(({ name }) => name === film.stock)?.title ?? film.stock;
}
