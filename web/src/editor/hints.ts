/** Reasons why a gesture does nothing, with what to do about it. */

import { MOST_CHANGES, type KeyOwner } from "../model/key_lanes";
import type { Shot } from "../model/shot";
import { HintError } from "../net/errors";

/** Hint for those who may not edit, by the reason; null for no reason. */
export function noEditsHint(reason: string | null): HintError | null {
  return reason === null ? null : new HintError(reason, "Whoever gave you the key can give you one that may.");
}

/** Where an edit would set or remove more keys than the service takes in one. */
export function tooManyKeysHint(): HintError {
  const most = Math.floor((MOST_CHANGES - 1) / 2).toString();
  return new HintError("These are too many keys at once.", `An edit takes some ${most} keys: select fewer of them.`);
}

/** Where the focus point is gone whose keys are edited. */
export function goneHint(owner: KeyOwner): HintError {
  const name = "point" in owner ? owner.point : owner.setting;
  return new HintError(`There is no ${name} any more.`, "Its keys went with it.");
}

/** Where the focus points of all copied keys are gone. */
export function nothingToPasteHint(): HintError {
  return new HintError("The points of the copied keys are gone.", "Copy other keys.");
}

/** Hint for a click on the picture of a shot that is framed by a camera without a prim. */
export function noCameraHint(shot: Shot): HintError {
  const hasOthers = shot.cameras.length > 0;
  const advice = hasOthers ? "Choose one above, or create one from this view." : "Create one from this view.";
  return new HintError("There is no camera to focus.", advice);
}
