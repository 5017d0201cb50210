/** Commands of the focus and its points. */

import type { Session } from "../../editor/session";
import { TOOLS, type Tool } from "../../editor/picks";
import { REACHES, type Reach } from "../../model/pull";
import { softest } from "../../model/sharpness";
import { FOCUS_MODES, inFrame, POINT_COLORS, type FocusMode, type FocusPoint } from "../../model/shot";
import { importCurve, mountLensFile } from "../file_choices";
import { onShot, type Command, type SessionCommand } from "./command";

const NO_POINT = "No focus point is selected.";

function mayEdit({ document }: Session): string | null {
  return document.noEdits.value ?? (document.hasLens ? null : "There is no camera to focus.");
}

/** A command on the selected focus point. */
function onPoint(
  name: string,
  keys: readonly string[],
  act: (session: Session, point: FocusPoint) => void,
): SessionCommand {
  return {
    name,
    keys,
    refusal: (session) => (session.selectedPoint.value ? mayEdit(session) : NO_POINT),
    act: (session) => {
      const point = session.selectedPoint.value;
      if (point) act(session, point);
    },
  };
}

const TOOL_NAMES: Readonly<Record<Tool, string>> = {
  pull: "A click pulls the focus",
  add: "A click adds a point",
  move: "A click moves the selected point",
};
const REACH_NAMES: Readonly<Record<Reach, string>> = {
  from: "Pull from here on",
  shot: "Pull for the whole shot",
  frame: "Pull at this frame",
};
const MODE_NAMES: Readonly<Record<FocusMode, string>> = {
  manual: "Focus by hand",
  points: "Focus by points",
  tiltPlane: "Focus by a tilted plane",
  surface: "Focus by a surface",
};

const CLICKS: readonly SessionCommand[] = [
  {
    name: "Click at the crosshair",
    keys: ["Enter"],
    wantsKey: ({ crosshair }) => crosshair.isHeld.value,
    refusal: (session) =>
      session.crosshair.at.value
        ? mayEdit(session)
        : "Go to the picture with Tab and move the crosshair by arrow keys.",
    act: ({ crosshair, picks }) => {
      if (crosshair.at.value) void picks.click(crosshair.at.value, picks.tool.value);
    },
  },
  ...TOOLS.map((tool, at): SessionCommand => ({
    name: TOOL_NAMES[tool],
    keys: [`Alt ${at + 1}`],
    isOn: ({ picks }) => picks.tool.value === tool,
    refusal: (session) => (tool === "move" && !session.selectedPoint.value ? NO_POINT : mayEdit(session)),
    act: ({ picks }) => {
      picks.choose(tool);
    },
  })),
  ...REACHES.map((reach, at): SessionCommand => ({
    name: REACH_NAMES[reach],
    keys: [`Alt ${at + 4}`],
    isOn: ({ pulls }) => pulls.choice.reach.value === reach,
    refusal: mayEdit,
    act: ({ pulls }) => void pulls.change({ reach }),
  })),
];

const MODES = FOCUS_MODES.map((mode, at): SessionCommand => ({
  name: MODE_NAMES[mode],
  keys: [`Alt Shift ${at + 1}`],
  isOn: ({ document }) => document.readout.value?.focusMode === mode,
  refusal: mayEdit,
  act: (session) => void session.setFocusMode(mode),
}));

const SELECTING: readonly SessionCommand[] = [
  {
    name: "Select the next point",
    keys: ["]"],
    refusal: hasPoints,
    act: (session) => {
      session.selectNext(1);
    },
  },
  {
    name: "Select the previous point",
    keys: ["["],
    refusal: hasPoints,
    act: (session) => {
      session.selectNext(-1);
    },
  },
  {
    name: "Select the softest point",
    keys: ["X"],
    refusal: hasPoints,
    act: (session) => {
      const found = softest(session.shownPoints.value.filter(inFrame), (point) => session.sharpnessOf(point));
      if (found) session.selected.value = found.name;
    },
  },
  {
    name: "Select nothing",
    keys: ["Escape"],
    refusal: ({ keys, selected }) =>
      keys.selectedStacks.value.length > 0 || selected.value !== null ? null : "Nothing is selected.",
    act: ({ keys, selected }) => {
      if (!keys.clear()) selected.value = null;
    },
  },
];

function hasPoints({ shownPoints }: Session): string | null {
  return shownPoints.value.some(inFrame) ? null : "There is no focus point in the picture.";
}

const POINTS: readonly SessionCommand[] = [
  onPoint("Pull the focus to the selected point", ["F"], (session, point) => {
    session.pullTo(point);
  }),
  onPoint("Go to the point’s previous key", [","], (session, point) => {
    session.goToKey(point, -1);
  }),
  onPoint("Go to the point’s next key", ["."], (session, point) => {
    session.goToKey(point, 1);
  }),
  onPoint("Set or remove the point’s weight key", ["S"], (session, point) => void session.toggleKey(point, "weight")),
  onPoint("Make the point sharp or soft", ["Shift S"], ({ pointEdits }, point) => {
    void pointEdits.setKind(point, point.settings.kind === "sharp" ? "soft" : "sharp");
  }),
  onPoint("Give the point the next colour", ["Shift G"], ({ pointEdits }, point) => {
    const next = POINT_COLORS[(POINT_COLORS.indexOf(point.color) + 1) % POINT_COLORS.length];
    if (next) void pointEdits.setColor(point, next);
  }),
  onPoint(
    "Let the point count, or not",
    ["E"],
    ({ pointEdits }, point) => void pointEdits.setEnabled(point, !point.settings.enabled),
  ),
  onPoint("Remove the point", ["Delete", "Backspace"], ({ pointEdits }, point) => {
    void pointEdits.remove(point);
  }),
];

const FILES: readonly SessionCommand[] = [
  { name: "Import a focus curve…", keys: ["Alt I"], refusal: mayEdit, act: importCurve },
  { name: "Mount a lens from a file…", keys: ["Alt L"], refusal: mayEdit, act: mountLensFile },
];

export const FOCUS_COMMANDS: readonly Command[] = [...CLICKS, ...SELECTING, ...POINTS, ...MODES, ...FILES].map(
  (command) => onShot("Focus", command),
);
