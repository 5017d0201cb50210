/** The panel on the right: the lens, what it holds sharp, how its focus is found, and the focus points. */

import type { JSX } from "preact";
import type { Editor } from "../editor/editor";
import { FocusPanel } from "./FocusPanel";
import { FocusPoints } from "./FocusPoints";
import { LensPanel } from "./LensPanel";

export function Inspector({ editor }: { editor: Editor }): JSX.Element {
  const session = editor.session.value;
  const unit = editor.remembered.unit.value;
  return (
    <aside class="inspector panel" aria-label="Lens and focus points">
      {session && !session.document.hasLens ? (
        <p class="muted pad-all">
          This shot has no camera, so one was made to frame it. Add a camera to the shot to set its lens and pull its
          focus.
        </p>
      ) : session ? (
        <>
          <LensPanel session={session} unit={unit} lenses={editor.lenses.value} />
          <FocusPanel session={session} />
          <FocusPoints session={session} unit={unit} />
        </>
      ) : (
        <p class="muted pad-all">The lens and the focus points of a shot show here.</p>
      )}
    </aside>
  );
}
