/** Reasons why a gesture does nothing, with what to do about it. */

import type { Changes } from "../model/changes";
import { labelOf, MOST_CHANGES, type KeyOwner } from "../model/key_lanes";
import { beyondLimits, MOST_TIME, MOST_VALUE, MOST_WIDTH, type Beyond } from "../model/key_limits";
import type { Shot } from "../model/shot";
import { HintError } from "../net/errors";

/** Hint for those who may not edit, by the reason; null for no reason. */
export function noEditsHint(reason: string | null): HintError | null {
  return reason === null ? null : new HintError(reason, "Whoever gave you the key can give you one that may.");
}

const BEYOND: Readonly<Record<Beyond, readonly [string, string]>> = {
  time: ["The keys would be too far away.", `Frames go from ${inDigits(-MOST_TIME)} to ${inDigits(MOST_TIME)}.`],
  value: ["The values would be too large.", `Values go from ${inDigits(-MOST_VALUE)} to ${inDigits(MOST_VALUE)}.`],
  handle: ["The handles of the keys would be too long or too steep.", handleAdvice()],
};

/** Where an edit would set or remove keys that the service does not take; null where it takes them. */
export function refusedKeysHint(changes: Changes): HintError | null {
  if (changes.length > MOST_CHANGES) {
    const most = Math.floor((MOST_CHANGES - 1) / 2).toString();
    return new HintError("These are too many keys at once.", `An edit takes some ${most} keys: select fewer of them.`);
  }
  const beyond = beyondLimits(changes);
  return beyond && new HintError(...BEYOND[beyond]);
}

function handleAdvice(): string {
  return `A handle may reach ${inDigits(MOST_WIDTH)} frames, and rise by ${inDigits(MOST_VALUE)} in each.`;
}

function inDigits(value: number): string {
  return value.toLocaleString("en").replace("-", "−");
}

/** Where the focus point is gone whose keys are edited. */
export function goneHint(owner: KeyOwner): HintError {
  const name = "point" in owner ? owner.point : labelOf(owner).toLowerCase();
  return new HintError(`There is no ${name} any more.`, "Its keys went with it.");
}

/** Where a focus point is gone that is to be edited. */
export function noPointHint(name: string): HintError {
  return new HintError(`There is no ${name} any more.`, "Select another point.");
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

/** Where a take cannot be made the focus. */
export function noTakeHint(isTooLong: boolean): HintError {
  return isTooLong
    ? new HintError("The take would be too many keys.", "Let it be farther off the distances that were recorded.")
    : new HintError("The focus before the take is not there yet.", "Try again once the focus curve is drawn.");
}

/** Where no frame from the punch-in to the punch-out is played. */
export function noPunchHint(): HintError {
  return new HintError(
    "None of the frames to record is played.",
    "Move the punch-in and the punch-out, or play other frames.",
  );
}

/** Where the browser cannot keep the takes of a shot. */
export function noRoomHint(): HintError {
  return new HintError(
    "The browser has no room to keep takes and marks.",
    "They last as long as the shot is open: apply the take, or delete takes that are not needed.",
  );
}
