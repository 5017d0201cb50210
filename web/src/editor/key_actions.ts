/** What can be done with the selected keys. */

import { hasValue, type KeyShape } from "../model/key_lanes";
import type { KeyEditing } from "./key_editing";

export interface KeyAction {
  readonly label: string;
  /** Chords of the keyboard. */
  readonly keys: readonly string[];
  /** Why it can do nothing now; null where it can. */
  readonly refusal: (keys: KeyEditing) => string | null;
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

const NO_KEYS = "No keys are selected.";
const hasSome = (keys: KeyEditing): boolean => keys.selectedStacks.value.length > 0;
const needsSome = (keys: KeyEditing): string | null => (hasSome(keys) ? null : NO_KEYS);
const mayEditSome = (keys: KeyEditing): string | null => keys.noEdits ?? needsSome(keys);

const COPY: KeyAction = {
  label: "Copy",
  keys: ["Ctrl C"],
  refusal: (keys) =>
    needsSome(keys) ??
    (keys.selectedStacks.value.some((stack) => stack.keys.some(hasValue))
      ? null
      : "Keys of the camera's place are set where it stands (Alt K), not copied."),
  act: (keys) => {
    keys.copy();
  },
};
const PASTE: KeyAction = {
  label: "Paste at the playhead",
  keys: ["Ctrl V"],
  refusal: (keys) => keys.noEdits ?? (keys.copied.value.length > 0 ? null : "No keys are copied."),
  act: (keys) => void keys.paste(),
};
const SELECT_LANES: KeyAction = {
  label: "Select all of the lane",
  keys: ["Ctrl A"],
  refusal: needsSome,
  act: (keys) => {
    keys.selectLanes();
  },
};
const REMOVE: KeyAction = {
  label: "Remove",
  keys: ["Delete", "Backspace"],
  refusal: mayEditSome,
  act: (keys) => void keys.remove(),
};
const MIRROR: KeyAction = {
  label: "Mirror in time",
  keys: ["Shift M"],
  refusal: (keys) => {
    const times = new Set(keys.selectedStacks.value.map(({ time }) => time));
    return mayEditSome(keys) ?? (times.size > 1 ? null : "All selected keys are at one time.");
  },
  act: (keys) => {
    keys.mirror();
  },
};

const STRETCH: KeyAction = {
  label: "Stretch to the playhead",
  keys: ["Shift T"],
  refusal: (keys) => mayEditSome(keys) ?? keys.noStretch,
  act: (keys) => {
    keys.stretchToPlayhead();
  },
};
const SIMPLIFY: KeyAction = {
  label: "Simplify the curve",
  keys: ["Shift U"],
  refusal: (keys) =>
    mayEditSome(keys) ?? (keys.whole.value ? null : "Select all keys of one setting of the camera that has several."),
  act: (keys) => {
    if (keys.whole.value) void keys.simplify(keys.whole.value);
  },
};

const SHAPE_ACTIONS = Object.entries(SHAPES).map(([shape, label], at): KeyAction => ({
  label,
  keys: [`${at + 1}`],
  refusal: mayEditSome,
  act: (keys) => {
    keys.shape(shape as KeyShape);
  },
}));

/** In the order of the menu. */
export const KEY_ACTIONS: readonly KeyAction[] = [
  COPY,
  PASTE,
  MIRROR,
  STRETCH,
  SIMPLIFY,
  SELECT_LANES,
  ...SHAPE_ACTIONS,
  REMOVE,
];
