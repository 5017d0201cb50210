/** The button that creates a camera from the view of a shot that has none. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";

const NAME = "Create a camera from this view";

interface CreateCameraProps {
  readonly editor: Editor;
  readonly session: Session;
  /** Where there is little room. */
  readonly label?: string;
}

export function CreateCamera({ editor, session, label }: CreateCameraProps): JSX.Element {
  const refusal = session.document.noEdits.value;
  return (
    <button
      type="button"
      class="button"
      aria-label={NAME}
      disabled={refusal !== null || session.document.pending.value > 0}
      title={refusal ?? `${NAME}: the edits get one that sees what is shown, with a Super 35 body and a thin lens`}
      onClick={() => {
        editor.createCamera();
      }}
    >
      {label ?? NAME}
    </button>
  );
}
