/** The keys of the page, in a dialog. */

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import { SHORTCUTS } from "../keyboard";

export function Help({ editor }: { editor: Editor }): JSX.Element {
  const ref = useRef<HTMLDialogElement>(null);
  const open = editor.helpOpen.value;
  useEffect(() => {
    if (open) ref.current?.showModal();
    else ref.current?.close();
  }, [open]);
  const close = (): void => {
    editor.helpOpen.value = false;
  };
  return (
    <dialog ref={ref} class="help" aria-labelledby="help-title" onClose={close}>
      <h2 id="help-title">Keys and clicks</h2>
      <dl>
        {SHORTCUTS.map(({ keys, does }) => (
          <div key={keys}>
            <dt>
              <kbd>{keys}</kbd>
            </dt>
            <dd>{does}</dd>
          </div>
        ))}
      </dl>
      <button type="button" class="button" onClick={close}>
        Close
      </button>
    </dialog>
  );
}
