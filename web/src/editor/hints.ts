/** Reasons why a gesture does nothing, with what to do about it. */

import type { Shot } from "../model/shot";
import { HintError } from "../net/errors";

/** Hint for those who may not edit, by the reason; null for no reason. */
export function noEditsHint(reason: string | null): HintError | null {
  return reason === null ? null : new HintError(reason, "Whoever gave you the key can give you one that may.");
}

/** Hint for a click on the picture of a shot that is framed by a camera without a prim. */
export function noCameraHint(shot: Shot): HintError {
  const hasOthers = shot.cameras.length > 0;
  const advice = hasOthers ? "Choose one above, or create one from this view." : "Create one from this view.";
  return new HintError("There is no camera to focus.", advice);
}
