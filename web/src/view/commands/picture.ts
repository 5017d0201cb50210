/** Commands of the tools on the picture. */

import { fullScreenRefusal, isFullScreen, toggleFullScreen } from "../full_screen";
import { COMPARISONS, type Comparing } from "../../model/comparison";
import { snapshotName } from "../viewer/present";
import { always, onShot, type Command } from "./command";

const ZOOM: readonly Command[] = [
  onShot("Picture", {
    name: "Whole picture, or its pixels 1:1",
    keys: ["Z"],
    isOn: ({ zoom }) => zoom.placing.value !== null,
    act: ({ zoom, probed }) => {
      zoom.toggle(probed.value);
    },
  }),
  onShot("Picture", {
    name: "Enlarge the picture",
    keys: ["Alt Z"],
    repeats: true,
    act: ({ zoom, probed }) => {
      zoom.step(1, probed.value);
    },
  }),
  onShot("Picture", {
    name: "Make the picture smaller",
    keys: ["Alt Shift Z"],
    repeats: true,
    act: ({ zoom, probed }) => {
      zoom.step(-1, probed.value);
    },
  }),
  onShot("Picture", {
    name: "Loupe at the pointer or crosshair",
    keys: ["N"],
    isOn: ({ zoom }) => zoom.loupe.value,
    act: ({ zoom }) => {
      zoom.loupe.value = !zoom.loupe.value;
    },
    letGo: ({ zoom }) => {
      zoom.loupe.value = false;
    },
  }),
  always("Picture", {
    name: "Picture on the full screen",
    keys: ["Alt F"],
    isOn: isFullScreen,
    refusal: fullScreenRefusal,
    act: () => void toggleFullScreen(),
  }),
];

const COMPARING: Readonly<Record<Exclude<Comparing, "off" | "other">, readonly [string, string]>> = {
  wipe: ["Wipe between the picture and another one", "Alt W"],
  difference: ["Difference of the picture and another one", "D"],
  flicker: ["Flicker between the picture and another one", "Alt Shift W"],
};

const COMPARE: readonly Command[] = [
  onShot("Picture", {
    name: "Take a snapshot of the picture",
    keys: ["H"],
    refusal: ({ pictures }) => (pictures.displayed.value === null ? "There is no picture yet." : null),
    act: (session, { editor }) => void session.comparison.take(snapshotName(editor, session)),
  }),
  ...COMPARISONS.flatMap((mode) =>
    mode === "off" || mode === "other"
      ? []
      : onShot("Picture", {
          name: COMPARING[mode][0],
          keys: [COMPARING[mode][1]],
          isOn: ({ comparison }) => comparison.mode.value === mode,
          act: ({ comparison }) => {
            comparison.toggle(mode);
          },
        }),
  ),
  onShot("Picture", {
    name: "The other picture alone, or the present one",
    keys: ["A"],
    isOn: ({ comparison }) => comparison.mode.value === "other" || comparison.showsOther.value,
    act: ({ comparison }) => {
      comparison.swap();
    },
    letGo: ({ comparison }) => {
      comparison.swap();
    },
  }),
];

const EXPOSURE: readonly Command[] = (
  [
    ["falseColour", "False colour of exposure", "Y"],
    ["zebra", "Zebra: stripes where it is bright", "Shift Y"],
  ] as const
).map(([look, name, key]) =>
  always("Picture", {
    name,
    keys: [key],
    isOn: ({ editor }) => editor.remembered.exposureLook.value === look,
    act: ({ editor: { remembered } }) => {
      remembered.exposureLook.value = remembered.exposureLook.value === look ? "none" : look;
    },
  }),
);

const SCOPES = always("Picture", {
  name: "Scopes: histogram, waveform, vectorscope",
  keys: ["Shift H"],
  isOn: ({ editor }) => editor.remembered.scopes.value === "on",
  act: ({ editor: { remembered } }) => {
    remembered.scopes.value = remembered.scopes.value === "on" ? "off" : "on";
  },
});

export const PICTURE_COMMANDS: readonly Command[] = [...ZOOM, ...COMPARE, ...EXPOSURE, SCOPES];
