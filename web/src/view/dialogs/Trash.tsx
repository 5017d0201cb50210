/** Deleted shots: the last one can be taken back at once, all of them until they are removed for good. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import type { TrashedShot } from "../../model/shot";

export function Trash({ editor }: { editor: Editor }): JSX.Element | null {
  const { trash, removed } = editor.library;
  if (trash.value.length === 0) return null;
  return (
    <>
      {removed.value && <Removed editor={editor} entry={removed.value} />}
      <details class="notes trash">
        <summary>Trash ({trash.value.length})</summary>
        <ul>
          {trash.value.map((entry) => (
            <li key={entry.id}>
              <span title={`Removed for good on ${new Date(entry.removedAt).toLocaleString()}`}>{entry.name}</span>
              <button
                type="button"
                class="button small"
                aria-label={`Restore ${entry.name}`}
                onClick={() => void editor.restore(entry)}
              >
                Restore
              </button>
            </li>
          ))}
        </ul>
      </details>
    </>
  );
}

function Removed({ editor, entry }: { editor: Editor; entry: TrashedShot }): JSX.Element {
  return (
    <div class="ask" role="status">
      <span>{entry.name} is in the trash.</span>
      <button type="button" class="button" onClick={() => void editor.restore(entry)}>
        Undo
      </button>
    </div>
  );
}
