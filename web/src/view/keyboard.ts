/** Keys that work anywhere on the page, except where the focused control has a use of its own for them. */

import type { Editor } from "../editor/editor";
import { COPY, PASTE, REMOVE, SELECT_LANES, type KeyAction } from "../editor/key_actions";
import type { Session } from "../editor/session";
import { LOOKS } from "../model/sharpness";
import { chooseRadio, controlOf, usesKey } from "./own_keys";

export interface Shortcut {
  readonly keys: string;
  readonly does: string;
}

/** For the help. */
export const SHORTCUTS: readonly Shortcut[] = [
  { keys: "Space", does: "Play or pause" },
  { keys: "J K L", does: "Play backwards, pause, play; J and L again play faster" },
  { keys: "I O", does: "Play from this frame on, or up to it; with Shift from the first frame, or up to the last" },
  { keys: "← →", does: "One frame back or forward" },
  { keys: "Shift ← →", does: "Ten frames back or forward" },
  { keys: "Home End", does: "First or last frame" },
  {
    keys: "Click",
    does: "Pull focus to the surface there at this time; in the modes tilt plane and surface, add a point",
  },
  {
    keys: "Shift click",
    does: "Add a focus point and keep the others; in the modes tilt plane and surface, pull focus",
  },
  { keys: "Alt click", does: "Move the selected point there" },
  { keys: "[ ]", does: "Select the previous or next point" },
  {
    keys: "F",
    does: "Pull focus to the selected point at this time; with keys selected or in the timeline, show them or the whole shot",
  },
  {
    keys: "+ −",
    does: "Show less or more of the shot's time, about the playhead; the wheel does so at the pointer, with Shift it pans",
  },
  { keys: ", .", does: "Go to its previous or next key" },
  { keys: "S", does: "Set or remove its weight key at this time" },
  { keys: "Delete", does: "Remove the selected keys, or else the selected point" },
  { keys: "Esc", does: "Select nothing" },
  {
    keys: "Drag a key",
    does: "Move the selected keys in time; they snap to frames, keys and the playhead, unless Alt is held",
  },
  {
    keys: "Shift click a key",
    does: "Select one more key, or one fewer; drag beside the keys to select those in a box",
  },
  { keys: "← → on a key", does: "Move the selected keys by a frame; with Shift by ten, with Alt by a tenth" },
  { keys: "↑ ↓ on a curve's key", does: "Raise or lower the selected keys by a step; with Shift by ten" },
  { keys: "Drag a curve's key", does: "Move the selected keys in time and value; with Shift along one of both" },
  {
    keys: "Drag a handle",
    does: "Shape the curve; with Alt the handle turns alone. The arrow keys move a focused one",
  },
  { keys: "Double click a curve", does: "Add a key there, on the curve" },
  { keys: "Ctrl C, Ctrl V", does: "Copy the selected keys; set them again from the playhead on" },
  { keys: "Ctrl A", does: "Select all keys of the lanes of the selected ones" },
  { keys: "Right click a key", does: "Open the menu of the keys, as the menu key does; a long touch, too" },
  { keys: "Ctrl Z", does: "Undo" },
  { keys: "Ctrl Shift Z", does: "Redo" },
  { keys: "M", does: "Show or hide the points" },
  { keys: "P", does: "Show what is sharp as peaking, as false colour, or not at all; with Shift as lines" },
  { keys: "C", does: "Switch between lens & focus and camera & film" },
  { keys: "G", does: "Go to the next framing guide" },
  { keys: "?", does: "Show this list" },
];

export function listenToKeys(target: Window, editor: Editor): void {
  target.addEventListener("keydown", (event) => {
    if (event.defaultPrevented || document.querySelector("dialog[open]")) return;
    const focused = event.target instanceof Element ? event.target : null;
    if (focused && chooseRadio(focused, event)) event.preventDefault();
    if (focused && usesKey(controlOf(focused), event)) return;
    const session = editor.session.value;
    const isWithControl = event.ctrlKey || event.metaKey;
    const handled = isWithControl ? controlKeys(event, session) : plainKeys(event, editor, session);
    if (handled) event.preventDefault();
  });
}

const WITH_CONTROL: Readonly<Record<string, KeyAction>> = { c: COPY, v: PASTE, a: SELECT_LANES };

function controlKeys(event: KeyboardEvent, session: Session | null): boolean {
  if (!session) return false;
  const key = event.key.toLowerCase();
  const action = WITH_CONTROL[key];
  if (action?.isPossible(session.keys)) {
    action.act(session.keys);
    return true;
  }
  if (key === "z" && !event.shiftKey) void session.document.undo();
  else if (key === "y" || key === "z") void session.document.redo();
  else return false;
  return true;
}

function plainKeys(event: KeyboardEvent, editor: Editor, session: Session | null): boolean {
  if (event.altKey) return false;
  if (event.key === "?") {
    editor.helpOpen.value = true;
    return true;
  }
  if (event.key.toLowerCase() === "m") {
    editor.remembered.markers.value = editor.remembered.markers.value === "on" ? "off" : "on";
    return true;
  }
  if (event.key.toLowerCase() === "p") {
    const { look, focusLines } = editor.remembered;
    if (event.shiftKey) focusLines.value = focusLines.value === "on" ? "off" : "on";
    else look.value = LOOKS[(LOOKS.indexOf(look.value) + 1) % LOOKS.length] ?? "none";
    return true;
  }
  if (event.key.toLowerCase() === "c") {
    editor.remembered.panel.value = editor.remembered.panel.value === "camera" ? "focus" : "camera";
    return true;
  }
  if (event.key.toLowerCase() === "g") {
    const names = ["", ...editor.libraries.value.shapes.map(({ name }) => name)];
    const { guide } = editor.remembered;
    guide.value = names[(names.indexOf(guide.value) + 1) % names.length] ?? "";
    return true;
  }
  return (
    session !== null &&
    (playKeys(event, session) || timeKeys(event, session) || keyKeys(event, session) || pointKeys(event, session))
  );
}

function playKeys(event: KeyboardEvent, { playhead }: Session): boolean {
  const mark = event.shiftKey ? null : playhead.time.value;
  switch (event.key.toLowerCase()) {
    case "j":
      if (!event.repeat) playhead.shuttle(-1);
      return true;
    case "k":
      playhead.pause();
      return true;
    case "l":
      if (!event.repeat) playhead.shuttle(1);
      return true;
    case "i":
      playhead.markFirst(mark);
      return true;
    case "o":
      playhead.markLast(mark);
      return true;
    default:
      return false;
  }
}

/** Zoom of the timeline for each press of a key. */
const KEY_ZOOM = 1.5;

function timeKeys(event: KeyboardEvent, session: Session): boolean {
  const { playhead, timeView } = session;
  const step = event.shiftKey ? 10 : 1;
  if (event.key === " ") playhead.toggle();
  else if (event.key === "ArrowLeft") playhead.step(-step);
  else if (event.key === "ArrowRight") playhead.step(step);
  else if (event.key === "+" || event.key === "=") timeView.zoom(1 / KEY_ZOOM);
  else if (event.key === "-") timeView.zoom(KEY_ZOOM);
  else if (event.key === "Home") playhead.goTo(playhead.range.start);
  else if (event.key === "End") playhead.goTo(playhead.range.end);
  else return false;
  return true;
}

/** Keys for the selected keys. */
function keyKeys(event: KeyboardEvent, { keys, timeView }: Session): boolean {
  if (event.key === "Escape") return keys.clear();
  const stacks = keys.selectedStacks.value;
  const isInTimeline = document.activeElement?.closest(".tracks") !== null && document.activeElement !== document.body;
  if (event.key.toLowerCase() === "f" && (stacks.length > 0 || isInTimeline)) {
    timeView.frame(stacks.map(({ time }) => time));
    return true;
  }
  if ((event.key !== "Delete" && event.key !== "Backspace") || keys.selectedStacks.value.length === 0) return false;
  REMOVE.act(keys);
  return true;
}

function pointKeys(event: KeyboardEvent, session: Session): boolean {
  const point = session.selectedPoint.value;
  if (event.key === "[" || event.key === "]") session.selectNext(event.key === "]" ? 1 : -1);
  else if (event.key === "Escape" && session.selected.value !== null) session.selected.value = null;
  else if (!point) return false;
  else if (event.key.toLowerCase() === "f") session.pullTo(point);
  else if (event.key === "," || event.key === ".") session.goToKey(point, event.key === "." ? 1 : -1);
  else if (event.key.toLowerCase() === "s") session.toggleKey(point, "weight");
  else if (event.key === "Delete" || event.key === "Backspace") session.pointEdits.remove(point);
  else return false;
  return true;
}
