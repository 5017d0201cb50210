/** Commands on the selected keys. */

import { KEY_ACTIONS } from "../../editor/key_actions";
import { onShot, type Command } from "./command";

export const KEY_COMMANDS: readonly Command[] = KEY_ACTIONS.map(({ label, keys, refusal, act }) =>
  onShot("Keys", {
    name: label,
    keys,
    refusal: (session) => refusal(session.keys),
    act: (session) => {
      act(session.keys);
    },
  }),
);
