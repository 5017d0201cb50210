/** The button that creates a camera from the view of a shot that has none. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";

export function CreateCamera({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const refusal = session.document.noEdits.value;
  return (
    <button
      type="button"
      class="button"
      disabled={refusal !== null || session.document.pending.value > 0}
      title={refusal ?? "Adds a camera to the edits that sees what is shown, with a Super 35 body and a thin lens"}
      onClick={() => {
        editor.createCamera();
      }}
    >
      Create a camera from this view
    </button>
  );
}
