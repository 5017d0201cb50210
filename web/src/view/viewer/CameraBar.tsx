/** The bar over the picture while the camera is moved: what a drag does, and whether it is a key. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { MOVES, type MoveKind } from "../../model/camera_moves";
import { Radios } from "../controls/Radios";
import { Icon } from "../icons";

const NAMES: Readonly<Record<MoveKind, string>> = { orbit: "Orbit", pan: "Pan", dolly: "Dolly" };
const TITLES: Readonly<Record<MoveKind, string>> = {
  orbit: "A drag turns the camera about the selected point, else about the focus; so do the arrow keys",
  pan: "A drag moves the camera in the plane of the picture (once with Shift; Shift and the arrow keys)",
  dolly: "A drag moves the camera along its axis (once with Ctrl; PageUp and PageDown)",
};

export function CameraBar({ session: { cameraMoves } }: { session: Session }): JSX.Element | null {
  if (!cameraMoves.isOn.value || cameraMoves.refusal !== null) return null;
  const isKeyed = cameraMoves.isKeyed.value;
  return (
    <div class="camera-bar" role="group" aria-label="Move the camera">
      <Radios
        label="What a drag does with the camera"
        values={MOVES}
        value={cameraMoves.kind.value}
        names={NAMES}
        titles={TITLES}
        onChoose={(kind) => (cameraMoves.kind.value = kind)}
      />
      <button
        type="button"
        class="button small"
        aria-pressed={isKeyed}
        title={
          isKeyed
            ? "A move is a key at this frame; press to move all of the camera’s way (Shift A)"
            : "A move takes all of the camera’s way along; press to set keys (Shift A)"
        }
        onClick={() => (cameraMoves.isKeyed.value = !isKeyed)}
      >
        Key
      </button>
      {cameraMoves.noWayBack === null && (
        <button
          type="button"
          class="button small"
          title="Take the camera back to where the shot has it, over all of its time; its keys of the edits go"
          onClick={() => void cameraMoves.reset()}
        >
          Shot’s place
        </button>
      )}
      <button
        type="button"
        class="button small icon-only quiet"
        aria-label="Stop moving the camera"
        title="Stop moving the camera (Shift E)"
        onClick={() => (cameraMoves.isOn.value = false)}
      >
        <Icon name="close" />
      </button>
    </div>
  );
}
