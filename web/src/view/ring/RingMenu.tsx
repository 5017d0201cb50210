/** What turns the ring besides the hand on the page, and how it is shown. */

import type { JSX } from "preact";
import type { Signal } from "@preact/signals";
import type { MidiState } from "../../editor/midi_input";
import type { PadState } from "../../editor/pad_input";
import type { RingDesk } from "../../editor/ring_desk";
import { WAYS } from "../../model/gamepad";
import { ORIGINS } from "../../model/ring";
import { Menu } from "../controls/Menu";
import { Radios } from "../controls/Radios";

export function RingMenu({ desk }: { desk: RingDesk }): JSX.Element {
  const { choices } = desk;
  return (
    <Menu name="ring-menu" label="Devices and distances" head="Devices" placement="top-end">
      {() => (
        <div class="ring-menu">
          <p class="menu-heading">MIDI</p>
          <Midi desk={desk} />
          <p class="menu-heading">Game controller</p>
          <Pad desk={desk} />
          <p class="menu-heading">Ring</p>
          <div class="ring-row">
            <span>Distances from</span>
            <Radios
              label="Distances from"
              values={ORIGINS}
              value={choices.origin.value}
              names={{ film: "Film plane", pupil: "Entrance pupil" }}
              onChoose={(origin) => (choices.origin.value = origin)}
            />
          </div>
          <Choice label="Marks draw the ring" choice={choices.snaps} />
          <Choice label="The picture follows the ring" choice={choices.follows} />
        </div>
      )}
    </Menu>
  );
}

function Choice({ label, choice }: { label: string; choice: Signal<"on" | "off"> }): JSX.Element {
  return (
    <label class="switch-row">
      <input
        type="checkbox"
        class="switch"
        checked={choice.value === "on"}
        onChange={({ currentTarget: { checked } }) => (choice.value = checked ? "on" : "off")}
      />
      {label}
    </label>
  );
}

const MIDI_NAMES: Readonly<Record<MidiState, string>> = {
  off: "Not connected",
  asking: "The browser asks you…",
  learning: "Turn a knob or a fader",
  on: "",
  refused: "The browser gives no MIDI devices",
};

function Midi({ desk: { midi } }: { desk: RingDesk }): JSX.Element {
  const [state, controller] = [midi.state.value, midi.controller];
  if (!midi.isPossible) return <p class="muted">This browser has no Web MIDI.</p>;
  const isConnected = state === "on" || state === "learning";
  const on = controller && `Controller ${controller.number}, channel ${controller.channel + 1}`;
  const none = isConnected && midi.devices.value === 0 ? "No device is there yet" : null;
  return (
    <div class="ring-row">
      <button
        type="button"
        class="button small"
        onClick={() => {
          if (isConnected) midi.close();
          else void midi.connect();
        }}
      >
        {isConnected ? "Disconnect MIDI" : "Connect MIDI"}
      </button>
      <button
        type="button"
        class="button small"
        disabled={!isConnected}
        onClick={() => {
          midi.learn();
        }}
      >
        Learn
      </button>
      <span class="muted" role="status">
        {none ?? (state === "on" ? on : MIDI_NAMES[state])}
      </span>
    </div>
  );
}

const PAD_NAMES: Readonly<Record<PadState, string>> = { off: "Off", learning: "Move a stick or a trigger", on: "" };

function Pad({ desk: { pad, choices } }: { desk: RingDesk }): JSX.Element {
  const [state, lever] = [pad.state.value, pad.lever];
  if (!pad.isPossible) return <p class="muted">This browser knows no game controllers.</p>;
  const on = lever && `${lever.kind === "axis" ? "Axis" : "Trigger"} ${lever.index}`;
  return (
    <div class="ring-row">
      <button
        type="button"
        class="button small"
        onClick={() => {
          if (state === "off") pad.connect();
          else pad.close();
        }}
      >
        {state === "off" ? "Use a game controller" : "Leave it"}
      </button>
      <button
        type="button"
        class="button small"
        disabled={state === "off"}
        onClick={() => {
          pad.learn();
        }}
      >
        Learn
      </button>
      <Radios
        label="A stick is"
        values={WAYS}
        value={choices.way.value}
        names={{ absolute: "Place", rate: "Speed" }}
        titles={{ absolute: "The stick is where the ring is", rate: "The stick turns the ring" }}
        onChoose={(way) => (choices.way.value = way)}
      />
      <span class="muted" role="status">
        {state !== "off" && !pad.isThere.value ? "Press a button on it" : state === "on" ? on : PAD_NAMES[state]}
      </span>
    </div>
  );
}
