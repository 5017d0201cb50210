/** The dialog of renders. Its content is a file of its own, which comes when it is opened first. */

import type { FunctionComponent, JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import { useModal } from "../hooks";

export interface RendersPanelProps {
  readonly editor: Editor;
  readonly close: () => void;
}

export function RendersDialog({ editor }: { editor: Editor }): JSX.Element {
  const isOpen = editor.rendersView.value !== null;
  const Panel = usePanel(editor, isOpen);
  const ref = useModal(isOpen);
  const close = (): void => {
    editor.rendersView.value = null;
  };
  return (
    <dialog
      ref={ref}
      class="renders"
      aria-label="Renders"
      onClose={close}
      onClick={(event) => {
        if (event.target === ref.current) close(); // beside it
      }}
    >
      {isOpen &&
        (Panel ? (
          <Panel editor={editor} close={close} />
        ) : (
          <p class="muted pad-all" role="status">
            Listing the renders…
          </p>
        ))}
    </dialog>
  );
}

/** The content of the dialog; null until it has come. Where it does not come, the dialog is closed, and the page says so. */
function usePanel(editor: Editor, isWanted: boolean): FunctionComponent<RendersPanelProps> | null {
  const [loaded, setLoaded] = useState<{ Panel: FunctionComponent<RendersPanelProps> } | null>(null);
  useEffect(() => {
    if (!isWanted || loaded) return;
    import("../renders/RendersPanel").then(
      ({ RendersPanel }) => {
        setLoaded({ Panel: RendersPanel });
      },
      (error: unknown) => {
        editor.rendersView.value = null;
        editor.fail(error, () => (editor.rendersView.value = "list"));
      },
    );
  }, [editor, isWanted, loaded]);
  return loaded?.Panel ?? null;
}
