/** What can be done with the selected keys: one table for the menu and the keyboard. */

import type { KeyShape } from "../model/key_lanes";
import type { KeyEditing } from "./key_editing";

export interface KeyAction {
  readonly label: string;
  /** Shortcut, as it is shown; empty for none. */
  readonly keys: string;
  readonly isPossible: (keys: KeyEditing) => boolean;
  readonly act: (keys: KeyEditing) => void;
}

/** How a curve goes through a key, in words. */
export const SHAPES: Readonly<Record<KeyShape, string>> = {
  held: "Held",
  linear: "Linear",
  auto: "Smooth",
  flat: "Flat",
  bezier: "Handles",
};

const hasSome = (keys: KeyEditing): boolean => keys.selectedStacks.value.length > 0;
const mayEdit = (keys: KeyEditing): boolean => keys.noEdits === null;

export const COPY: KeyAction = {
  label: "Copy",
  keys: "Ctrl C",
  isPossible: hasSome,
  act: (keys) => {
    keys.copy();
  },
};
export const PASTE: KeyAction = {
  label: "Paste at the playhead",
  keys: "Ctrl V",
  isPossible: (keys) => mayEdit(keys) && keys.copied.value.length > 0,
  act: (keys) => void keys.paste(),
};
export const SELECT_LANES: KeyAction = {
  label: "Select all of the lane",
  keys: "Ctrl A",
  isPossible: hasSome,
  act: (keys) => {
    keys.selectLanes();
  },
};
export const REMOVE: KeyAction = {
  label: "Remove",
  keys: "Delete",
  isPossible: (keys) => mayEdit(keys) && hasSome(keys),
  act: (keys) => void keys.remove(),
};
const MIRROR: KeyAction = {
  label: "Mirror in time",
  keys: "",
  isPossible: (keys) => mayEdit(keys) && new Set(keys.selectedStacks.value.map(({ time }) => time)).size > 1,
  act: (keys) => {
    keys.mirror();
  },
};

const SHAPE_ACTIONS = Object.entries(SHAPES).map(([shape, label]): KeyAction => ({
  label,
  keys: "",
  isPossible: (keys) => mayEdit(keys) && hasSome(keys),
  act: (keys) => {
    keys.shape(shape as KeyShape);
  },
}));

/** In the order of the menu. */
export const KEY_ACTIONS: readonly KeyAction[] = [COPY, PASTE, MIRROR, SELECT_LANES, ...SHAPE_ACTIONS, REMOVE];
