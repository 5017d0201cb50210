/** Commands of the camera: how it is moved, keyed and duplicated. */

import type { Session } from "../../editor/session";
import { onShot, type Command } from "./command";

const mayMove = ({ cameraMoves }: Session): string | null => cameraMoves.refusal;

export const CAMERA_COMMANDS: readonly Command[] = [
  onShot("Shot", {
    name: "Move the camera",
    keys: ["Shift E"],
    isOn: ({ cameraMoves }) => cameraMoves.isOn.value,
    refusal: mayMove,
    act: ({ cameraMoves }) => {
      cameraMoves.isOn.value = !cameraMoves.isOn.value;
    },
  }),
  onShot("Shot", {
    name: "Moves of the camera are keys",
    keys: ["Shift A"],
    isOn: ({ cameraMoves }) => cameraMoves.isKeyed.value,
    refusal: mayMove,
    act: ({ cameraMoves }) => {
      cameraMoves.isKeyed.value = !cameraMoves.isKeyed.value;
    },
  }),
  onShot("Shot", {
    name: "Key the camera where it stands",
    keys: ["Alt K"],
    refusal: mayMove,
    act: ({ cameraMoves }) => void cameraMoves.key(),
  }),
  onShot("Shot", {
    name: "Take the camera’s key at this frame away",
    keys: ["Alt Shift K"],
    refusal: ({ cameraMoves }) => cameraMoves.noKeyHere,
    act: ({ cameraMoves }) => void cameraMoves.unkey(),
  }),
  onShot("Shot", {
    name: "Frame the selected point",
    keys: ["Shift X"],
    refusal: (session) =>
      session.selectedPoint.value?.positionM ? mayMove(session) : "No focus point that has a place is selected.",
    act: ({ cameraMoves, selectedName }) => {
      if (selectedName.value !== null) void cameraMoves.frame(selectedName.value);
    },
  }),
  onShot("Shot", {
    name: "Duplicate the camera",
    keys: ["Shift D"],
    refusal: mayMove,
    act: (_, { editor }) => {
      editor.duplicateCamera();
    },
  }),
];
