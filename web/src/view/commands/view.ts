/** Commands of what is shown and how. */

import type { Signal } from "@preact/signals";
import { FOLDABLE, type Foldable } from "../../editor/layout";
import { PLAN_UPS, SURROUNDS, type Remembered } from "../../editor/remembered";
import { nextGuides, nextMask, type GuideMark } from "../../model/guides";
import { LOOKS, type Look } from "../../model/sharpness";
import { always, nextOf, onShot, type Command, type Place } from "./command";

type Switch = "markers" | "focusLines" | "probe" | "motion" | "topView" | "burnInShown";

function toggle(remembered: Remembered, name: Switch): void {
  const choice: Signal<"on" | "off"> = remembered[name];
  choice.value = choice.value === "on" ? "off" : "on";
}

function onSwitch(name: string, keys: readonly string[], choice: Switch): Command {
  return always("View", {
    name,
    keys,
    isOn: ({ editor }) => editor.remembered[choice].value === "on",
    act: ({ editor }) => {
      toggle(editor.remembered, choice);
    },
  });
}

const LOOK_NAMES: Readonly<Record<Look, string>> = {
  none: "No colours of sharpness",
  peaking: "Peaking",
  falseColour: "False colour of focus",
};

const SHARPNESS: readonly Command[] = [
  always("View", {
    name: "Next colours of sharpness",
    keys: ["P"],
    act: ({ editor: { remembered } }) => {
      remembered.look.value = nextOf(LOOKS, remembered.look.value);
    },
  }),
  ...LOOKS.map((look, at) =>
    always("View", {
      name: LOOK_NAMES[look],
      keys: [`Shift ${at + 1}`],
      isOn: ({ editor }) => editor.remembered.look.value === look,
      act: ({ editor }) => {
        editor.remembered.look.value = look;
      },
    }),
  ),
  onSwitch("Lines of focus and its limits", ["Shift P"], "focusLines"),
  onSwitch("Probe at the pointer", ["Q"], "probe"),
  onSwitch("Focus points on the picture", ["M"], "markers"),
  onSwitch("Motion blur", ["B"], "motion"),
];

export const PANEL_NAMES: Readonly<Record<Foldable, string>> = {
  shots: "Shots",
  settings: "Settings",
  curve: "Curve and keys",
};

const PANELS: readonly Command[] = [
  always("View", {
    name: "Lens & focus, or camera & film",
    keys: ["C"],
    act: ({ editor: { remembered, layout } }) => {
      remembered.panel.value = remembered.panel.value === "camera" ? "focus" : "camera";
      layout.show("settings", true);
    },
  }),
  ...FOLDABLE.map((panel, at) =>
    always("View", {
      name: PANEL_NAMES[panel],
      keys: [`Shift ${at + 7}`],
      isOn: ({ editor }) => editor.layout.isShown(panel),
      act: ({ editor }) => {
        editor.layout.toggle(panel);
      },
    }),
  ),
  onSwitch("Top view", ["V"], "topView"),
  always("View", {
    name: "Camera or north up in the top view",
    keys: ["Shift V"],
    act: ({ editor: { remembered } }) => {
      remembered.planUp.value = nextOf(PLAN_UPS, remembered.planUp.value);
    },
  }),
  onShot("View", {
    name: "Next curve",
    keys: ["T"],
    refusal: ({ keys }) => (keys.curves.value.length === 0 ? "Only the focus has a curve." : null),
    act: ({ keys }) => {
      const ids = [null, ...keys.curves.value.map(({ id }) => id)];
      keys.graphed.value = nextOf(ids, keys.graph.value?.saved.id ?? null);
    },
  }),
];

/** A switch of marks: all of them, or none. */
function marksSwitch(name: string, keys: readonly string[], marks: readonly GuideMark[]): Command {
  const isOn = ({ editor }: Place): boolean => marks.some((mark) => editor.remembered.marks.has(mark));
  return always("View", {
    name,
    keys,
    isOn,
    act: (place) => {
      const chosen = place.editor.remembered.marks;
      const others = chosen.names.filter((mark) => !marks.some((one) => one === mark));
      chosen.names = isOn(place) ? others : [...others, ...marks];
    },
  });
}

const GUIDES: readonly Command[] = [
  always("View", {
    name: "Next framing guide",
    keys: ["G"],
    act: ({ editor }) => {
      const { guides } = editor.remembered;
      guides.names = nextGuides(guides.names, editor.libraries.value.shapes);
    },
  }),
  marksSwitch("Safe areas", ["Alt A"], ["action", "title"]),
  marksSwitch("Thirds", ["Alt H"], ["thirds"]),
  marksSwitch("Centre cross", ["Alt X"], ["cross"]),
  always("View", {
    name: "Next darkness outside of the smallest guide",
    keys: ["Shift Q"],
    act: ({ editor: { remembered } }) => {
      remembered.mask.value = nextMask(remembered.mask.value);
    },
  }),
  onSwitch("Burn-ins on the picture", ["Alt B"], "burnInShown"),
];

const LOOKS_OF_THE_PAGE: readonly Command[] = [
  always("View", {
    name: "Next surround of the picture",
    keys: ["Shift B"],
    act: ({ editor: { remembered } }) => {
      remembered.surround.value = nextOf(SURROUNDS, remembered.surround.value);
    },
  }),
  always("View", {
    name: "Metres, or feet and inches",
    keys: ["U"],
    act: ({ editor: { remembered } }) => {
      remembered.unit.value = remembered.unit.value === "m" ? "ft" : "m";
    },
  }),
  always("View", {
    name: "All commands",
    keys: ["Ctrl K"],
    act: ({ editor }) => {
      editor.paletteOpen.value = true;
    },
  }),
  always("View", {
    name: "Keys and clicks",
    keys: ["?"],
    act: ({ editor }) => {
      editor.helpOpen.value = true;
    },
  }),
];

export const VIEW_COMMANDS: readonly Command[] = [...SHARPNESS, ...PANELS, ...GUIDES, ...LOOKS_OF_THE_PAGE];
