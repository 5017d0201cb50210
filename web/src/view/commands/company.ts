/** Commands of those who look at the same shot. */

import { goToOther } from "../../editor/viewers";
import { nextOther } from "../../model/viewers";
import { onShot, type Command } from "./command";

export const COMPANY_COMMANDS: readonly Command[] = [
  onShot("Shot", {
    name: "Who else is here",
    keys: [],
    refusal: ({ pictures }) => (pictures.others.value.length > 0 ? null : "Nobody else looks at this shot."),
    act: (_, { editor }) => {
      editor.layout.show("shots", true);
      editor.companyCalled.value = true;
    },
  }),
  onShot("Shot", {
    name: "Go to the frame of the next person here",
    keys: [],
    refusal: ({ pictures }) =>
      pictures.others.value.some(({ time }) => time !== null) ? null : "Nobody else looks at a frame of this shot.",
    act: ({ pictures, playhead, camera }, { editor }) => {
      const other = nextOther(pictures.others.value, playhead.time.value, camera);
      if (other) void goToOther(editor, other);
    },
  }),
];
