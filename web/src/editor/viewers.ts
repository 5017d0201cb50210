/** Going to where others look. */

import type { Other } from "../model/viewers";
import type { Editor } from "./editor";

/** Goes to the frame of somebody else, and looks through the same camera. */
export async function goToOther(editor: Editor, { camera, time }: Other): Promise<void> {
  const session = editor.session.value;
  if (!session || time === null) return;
  const { shot, playhead } = session;
  if (camera === null || camera === session.camera || !shot.cameraPaths.includes(camera)) playhead.goTo(time);
  else await editor.open(shot.id, camera, time);
}
