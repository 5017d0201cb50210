/** Clicks and drags, for the help; and keys whose meaning depends on what the keyboard is on. */

export interface Gesture {
  readonly gesture: string;
  readonly does: string;
}

export const GESTURES: readonly Gesture[] = [
  {
    gesture: "Click",
    does: "Do at the surface there what the line below the picture says: pull the focus, add or move a point",
  },
  {
    gesture: "Shift click",
    does: "Add a focus point and keep the others; in the modes tilt plane and surface, pull focus",
  },
  { gesture: "Alt click", does: "Move the selected point there" },
  { gesture: "Drag a marker", does: "Move its point to another place of the scene" },
  {
    gesture: "Tab to the picture",
    does: "Take the crosshair: the arrow keys move it, Enter clicks, with Shift or Alt as the pointer does",
  },
  {
    gesture: "Drag a point in the top view",
    does: "Move it at its height; the arrow keys move a focused one by a tenth of a square, with Shift by a whole one",
  },
  {
    gesture: "Drag the handle in the top view",
    does: "Set the focus distance, where the points do not; so do the arrow keys",
  },
  { gesture: "Wheel in the top view", does: "Zoom at the pointer; a drag moves the drawing" },
  {
    gesture: "Ctrl wheel on the picture",
    does: "Enlarge it at the pointer, or make it smaller, as pinching does; the wheel alone moves an enlarged picture",
  },
  { gesture: "Drag with Space or the middle button", does: "Move an enlarged picture; on touch screens a finger does" },
  {
    gesture: "Alt drag on the picture",
    does: "Orbit the camera about the selected point, else about the focus; with the middle button pan, with the right one dolly",
  },
  {
    gesture: "Drag while the camera is moved",
    does: "Orbit; with Shift pan, with Ctrl dolly. The arrow keys orbit, with Shift they pan, PageUp and PageDown dolly",
  },
  { gesture: "Drag in the timeline", does: "Go through time" },
  {
    gesture: "Wheel in the timeline",
    does: "Show less or more of the shot’s time at the pointer; with Shift go through it",
  },
  {
    gesture: "Drag a key",
    does: "Move the selected keys in time; they snap to frames, keys and the playhead, unless Alt is held",
  },
  {
    gesture: "Shift click a key",
    does: "Select one more key, or one fewer; drag beside the keys to select those in a box",
  },
  { gesture: "← → on a key", does: "Move the selected keys by a frame; with Shift by ten, with Alt by a tenth" },
  { gesture: "↑ ↓ on a curve’s key", does: "Raise or lower the selected keys by a step; with Shift by ten" },
  { gesture: "Drag a curve’s key", does: "Move the selected keys in time and value; with Shift along one of both" },
  {
    gesture: "Drag a handle",
    does: "Shape the curve; with Alt the handle turns alone. The arrow keys move a focused one",
  },
  { gesture: "Double click a curve", does: "Add a key there, on the curve" },
  { gesture: "Right click a key", does: "Open the menu of the keys, as the menu key does; a long touch, too" },
];
