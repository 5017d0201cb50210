/** Commands of the focus ring. */

import { onShot, type Command, type SessionCommand } from "./command";

const RING: readonly SessionCommand[] = [
  {
    name: "Focus ring",
    keys: ["W"],
    isOn: ({ desk }) => desk.choices.shown.value === "on",
    act: ({ desk }) => {
      const { shown } = desk.choices;
      shown.value = shown.value === "on" ? "off" : "on";
    },
  },
  {
    name: "Record a pull of the ring, or end it",
    keys: ["Shift W"],
    isOn: ({ desk }) => desk.recorder.state.value !== "off",
    refusal: ({ desk }) => desk.refusal,
    act: ({ desk }) => {
      desk.choices.shown.value = "on";
      desk.record();
    },
  },
  {
    name: "Punch in at this frame",
    keys: ["Alt Shift I"],
    refusal: ({ desk }) => desk.refusal,
    act: ({ desk, playhead }) => {
      desk.punch({ punchIn: playhead.time.value });
    },
  },
  {
    name: "Punch out at this frame",
    keys: ["Alt Shift O"],
    refusal: ({ desk }) => desk.refusal,
    act: ({ desk, playhead }) => {
      desk.punch({ punchOut: playhead.time.value });
    },
  },
];

export const RING_COMMANDS: readonly Command[] = RING.map((command) => onShot("Focus", command));
