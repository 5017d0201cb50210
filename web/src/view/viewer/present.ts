/** The picture on screen in words: what a snapshot is called. */

import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { formatDistance } from "../../model/distance";
import { saidOf } from "../../model/lens";
import { primName } from "../../model/shot";
import { formatFrame } from "../../model/time";

interface Present {
  readonly shot: string;
  readonly camera: string;
  readonly frame: string;
  /** The lens and its stop. */
  readonly lens: string;
  readonly distance: string;
}

/** What the picture on screen is of; empty where there is no lens. */
function presentOf(editor: Editor, session: Session): Present {
  const shown = session.pictures.displayed.value;
  const readout = session.document.hasLens ? session.document.readout.value : null;
  return {
    shot: session.shot.name,
    camera: session.camera === null ? "framing camera" : primName(session.camera),
    frame: formatFrame(shown?.time ?? session.playhead.time.value),
    lens: readout ? saidOf(readout) : "",
    distance: readout ? formatDistance(readout.focusDistanceM, editor.remembered.unit.value) : "",
  };
}

/** Name of a snapshot. */
export function snapshotName(editor: Editor, session: Session): string {
  const { frame, camera, lens, distance } = presentOf(editor, session);
  return [`frame ${frame}`, camera, lens, distance].filter(Boolean).join(", ");
}
