/** The keys and gestures of the page, in a dialog. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import { MENUS } from "../commands/command";
import { GESTURES } from "../commands/gestures";
import { commandsOf, shownKeys } from "../commands/table";
import { TitledDialog } from "./TitledDialog";

export function Help({ editor }: { editor: Editor }): JSX.Element {
  const close = (): void => {
    editor.helpOpen.value = false;
  };
  return (
    <TitledDialog name="keys" title="Keys and clicks" isOpen={editor.helpOpen.value} close={close}>
      <Lists />
    </TitledDialog>
  );
}

function Lists(): JSX.Element {
  return (
    <div class="help-lists" tabIndex={0} role="group" aria-label="Keys and clicks">
      <List title="Clicks and drags" rows={GESTURES.map(({ gesture, does }) => [gesture, does])} />
      {MENUS.map((menu) => (
        <List
          key={menu}
          title={menu}
          rows={commandsOf(menu)
            .filter(({ keys }) => keys.length > 0)
            .map((command) => [shownKeys(command), command.name])}
        />
      ))}
    </div>
  );
}

function List({ title, rows }: { title: string; rows: readonly (readonly [string, string])[] }): JSX.Element {
  return (
    <section>
      <h3>{title}</h3>
      <dl>
        {rows.map(([keys, does]) => (
          <div key={does}>
            <dt>
              <kbd>{keys}</kbd>
            </dt>
            <dd>{does}</dd>
          </div>
        ))}
      </dl>
    </section>
  );
}
