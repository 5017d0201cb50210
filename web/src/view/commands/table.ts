/** All commands of the page, and what is told of gestures that are none. */

import type { Editor } from "../../editor/editor";
import { CAMERA_COMMANDS } from "./camera";
import { isChord, shownChord, type KeyStroke } from "./chord";
import { MENUS, type Command, type MenuName, type Place } from "./command";
import { COMPANY_COMMANDS } from "./company";
import { FOCUS_COMMANDS } from "./focus";
import { KEY_COMMANDS } from "./keys";
import { DRAFT_COMMANDS, NOTE_COMMANDS } from "./notes";
import { PICTURE_COMMANDS } from "./picture";
import { PLAY_COMMANDS } from "./play";
import { RING_COMMANDS } from "./ring";
import { SHOT_COMMANDS } from "./shot";
import { VIEW_COMMANDS } from "./view";

/** In the order of the menus. Where several have a key, the first that can do something has it. */
export const COMMANDS: readonly Command[] = [
  ...DRAFT_COMMANDS,
  ...SHOT_COMMANDS,
  ...COMPANY_COMMANDS,
  ...CAMERA_COMMANDS,
  ...KEY_COMMANDS,
  ...PLAY_COMMANDS,
  ...FOCUS_COMMANDS,
  ...RING_COMMANDS,
  ...VIEW_COMMANDS,
  ...PICTURE_COMMANDS,
  ...NOTE_COMMANDS,
];

const BY_MENU: ReadonlyMap<MenuName, readonly Command[]> = new Map(
  MENUS.map((name) => [name, COMMANDS.filter(({ menu }) => menu === name)]),
);

export function commandsOf(menu: MenuName): readonly Command[] {
  return BY_MENU.get(menu) ?? [];
}

/** The command that a key press means, if any. */
export function commandOf(stroke: KeyStroke, place: Place): Command | null {
  return (
    COMMANDS.find(
      ({ keys, wantsKey, refusal }) =>
        keys.some((chord) => isChord(chord, stroke)) && wantsKey?.(place) !== false && refusal(place) === null,
    ) ?? null
  );
}

/** Whether a key press belongs to a command of files even where that can do nothing now: the browser would save or search the page. */
export function isReserved(stroke: KeyStroke): boolean {
  return COMMANDS.some(
    ({ menu, keys }) => menu === "Shot" && keys.some((chord) => chord.startsWith("Ctrl ") && isChord(chord, stroke)),
  );
}

/** What commands act on now. */
export function placeOf(editor: Editor): Place {
  const isInTimeline = Boolean(document.activeElement?.closest(".tracks"));
  return { editor, session: editor.session.value, isInTimeline };
}

/** The keys of a command as they are shown; empty for one without. */
export function shownKeys({ keys }: Command): string {
  return shownChord(keys[0] ?? "");
}

/** Commands whose names and menus have all words of what is typed. */
export function found(typed: string): readonly Command[] {
  const words = typed.toLowerCase().split(/\s+/).filter(Boolean);
  return COMMANDS.filter(({ name, menu }) => {
    const text = `${menu} ${name}`.toLowerCase();
    return words.every((word) => text.includes(word));
  });
}
