/** A sheet about a lens or a film, as large as the window lets it be. */

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import type { Editor, Sheet } from "../../editor/editor";
import { useModal } from "../hooks";

export function SheetDialog({ editor }: { editor: Editor }): JSX.Element {
  const sheet = editor.sheet.value;
  const ref = useModal(sheet !== null);
  const close = (): void => {
    editor.sheet.value = null;
  };
  return (
    <dialog ref={ref} class="sheet" aria-label={sheet ? `Sheet of ${sheet.title}` : "Sheet"} onClose={close}>
      {sheet && <Drawing key={sheet.address} sheet={sheet} />}
      <div class="sheet-foot">
        {sheet && (
          <a class="button" href={sheet.address} download={`${sheet.title}.png`}>
            Download
          </a>
        )}
        <button type="button" class="button" onClick={close}>
          Close
        </button>
      </div>
    </dialog>
  );
}

function Drawing({ sheet }: { sheet: Sheet }): JSX.Element {
  const [state, setState] = useState<"coming" | "there" | "lost">("coming");
  return (
    <>
      {state !== "there" && (
        <p class="muted pad-all" role="status">
          {state === "lost"
            ? `The sheet of ${sheet.title} could not be drawn.`
            : `Drawing the sheet of ${sheet.title}…`}
        </p>
      )}
      <img
        src={sheet.address}
        alt={`Sheet of ${sheet.title}`}
        hidden={state !== "there"}
        onLoad={() => {
          setState("there");
        }}
        onError={() => {
          setState("lost");
        }}
      />
    </>
  );
}
