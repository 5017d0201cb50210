/** The menu of the keys: it opens where the pointer is, or at the focused key by the menu key of the keyboard. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import { KEY_COMMANDS } from "../commands/keys";
import { CommandMenu } from "../menus/CommandMenu";

/** Where a menu is open, CSS px of the window. */
export interface MenuPlace {
  readonly x: number;
  readonly y: number;
}

interface KeyMenuProps {
  readonly editor: Editor;
  readonly place: MenuPlace;
  readonly close: () => void;
}

export function KeyMenu({ editor, place, close }: KeyMenuProps): JSX.Element {
  return <CommandMenu editor={editor} label="Keys" commands={KEY_COMMANDS} anchor={place} close={close} />;
}
