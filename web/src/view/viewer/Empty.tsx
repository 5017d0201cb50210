/** The viewer with no shot open: what is opened, or what can be. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import { UploadButton } from "../dialogs/Shots";
import { OpeningPoster } from "./Poster";

/** Id of the shot that services come with. */
const DEMO = "demo";

export function Empty({ editor }: { editor: Editor }): JSX.Element {
  const wait = editor.waits.of("opening");
  if (wait) return <OpeningPoster editor={editor} wait={wait} />;
  const { shots } = editor.library;
  if (shots.value === null)
    return (
      <div class="empty">
        <p role="status">{editor.complaint.value ? "The shots could not be listed." : "Listing the shots…"}</p>
      </div>
    );
  return <Invitation editor={editor} />;
}

/** One sentence that says what to do, and the button for it. */
function Invitation({ editor }: { editor: Editor }): JSX.Element {
  const { shots, trash } = editor.library;
  const demo = shots.value?.find(({ id }) => id === DEMO);
  const thrown = trash.value.find(({ shot }) => shot === DEMO);
  const mayEdit = editor.identity.noEdits.value === null;
  const first = shots.value?.[0];
  const offer = demo ?? (thrown && mayEdit ? undefined : first);
  const drop = mayEdit
    ? "Drop a USD file here, or a .zip of a shot with what it references"
    : "Choose one of the shots";
  const open = offer || thrown ? `, or open ${demo || thrown ? "the demo shot" : (offer?.name ?? "")}` : "";
  return (
    <div class="empty">
      <h2>No shot is open</h2>
      <p>{`${drop}${open}.`}</p>
      <div class="empty-actions">
        {offer ? (
          <button type="button" class="button primary" onClick={() => void editor.open(offer.id)}>
            Open {demo ? "the demo shot" : offer.name}
          </button>
        ) : (
          thrown &&
          mayEdit && (
            <button type="button" class="button primary" onClick={() => void editor.restore(thrown)}>
              Open the demo shot
            </button>
          )
        )}
        <UploadButton editor={editor} label="Add a shot" />
      </div>
    </div>
  );
}
