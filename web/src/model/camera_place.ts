/** The place of a camera over time: the keys of its own transform. */

import type { Change } from "./changes";
import type { Key } from "./keys";

export interface CameraPlace {
  /** In order of time, by `CAMERA_PLACE` of the lanes. */
  readonly keys: readonly Key[];
  /** Whether the edits have any part in it. */
  readonly isEdited: boolean;
  /** Whether the shot itself has the camera. */
  readonly isInShot: boolean;
}

const PLACING: ReadonlySet<Change["type"]> = new Set<Change["type"]>([
  "moveCamera",
  "frameSubject",
  "unkeyCamera",
  "moveCameraKeys",
  "resetCameraPlace",
  "createCamera",
  "duplicateCamera",
  "chooseVariant",
  "showPayload",
]);

/** Whether a change may give a camera another place. */
export function mayPlaceCamera({ type }: Change): boolean {
  return PLACING.has(type);
}
