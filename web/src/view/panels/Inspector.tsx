/** The panel on the right: the lens, what it holds sharp, how its focus is found, and the focus points; or the camera. */

import type { JSX } from "preact";
import { useRef } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import { PANELS, type Panel } from "../../editor/remembered";
import type { Session } from "../../editor/session";
import { CreateCamera } from "../controls/CreateCamera";
import { Edits } from "../controls/Edits";
import { Splitter } from "../controls/Splitter";
import { CameraPanel } from "./CameraPanel";
import { FocusPanel } from "./FocusPanel";
import { FocusPoints } from "./FocusPoints";
import { LensPanel } from "./LensPanel";
import { FoldedContext } from "./Section";

export function Inspector({ editor }: { editor: Editor }): JSX.Element {
  const session = editor.session.value;
  const unit = editor.remembered.unit.value;
  const side = useRef<HTMLElement>(null);
  return (
    <aside ref={side} class="side inspector" aria-label="Lens, focus and camera">
      <Splitter layout={editor.layout} panel="settings" label="Width of the settings" of={side} />
      <div class="panel">
        {session && !session.document.hasLens ? (
          <div class="pad-all">
            <p class="muted">
              {session.shot.cameras.length === 0
                ? "This shot has no camera, so one was made to frame it. Create a camera from this view to set its lens and pull its focus."
                : "None of the shot’s cameras is its main one, so all of it is framed. Choose a camera above, or create one from this view."}
            </p>
            <CreateCamera editor={editor} session={session} />
          </div>
        ) : session ? (
          <FoldedContext.Provider value={editor.remembered.folded}>
            <Tabs editor={editor} />
            <ReadOnly session={session} />
            {editor.remembered.panel.value === "camera" ? (
              <div role="tabpanel" id="panel-camera" aria-labelledby="tab-camera">
                <CameraPanel editor={editor} session={session} />
              </div>
            ) : (
              <div role="tabpanel" id="panel-focus" aria-labelledby="tab-focus">
                <LensPanel editor={editor} session={session} unit={unit} />
                <Edits session={session}>
                  <FocusPanel editor={editor} session={session} />
                </Edits>
                <FocusPoints editor={editor} session={session} />
              </div>
            )}
          </FoldedContext.Provider>
        ) : (
          <p class="muted pad-all">The lens and the focus points of a shot show here.</p>
        )}
      </div>
    </aside>
  );
}

function ReadOnly({ session }: { session: Session }): JSX.Element | null {
  const reason = session.document.noEdits.value;
  return reason === null ? null : (
    <p class="read-only" role="note">
      {reason}
    </p>
  );
}

const PANEL_NAMES: Readonly<Record<Panel, string>> = { focus: "Lens & focus", camera: "Camera & film" };

function Tabs({ editor }: { editor: Editor }): JSX.Element {
  const { panel } = editor.remembered;
  return (
    <div class="tabs" role="tablist" aria-label="What is set here">
      {PANELS.map((name) => (
        <button
          key={name}
          type="button"
          role="tab"
          id={`tab-${name}`}
          aria-selected={panel.value === name}
          aria-controls={`panel-${name}`}
          tabIndex={panel.value === name ? 0 : -1}
          title={`${PANEL_NAMES[name]} (C)`}
          onClick={() => (panel.value = name)}
          onKeyDown={(event) => {
            if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
            event.preventDefault();
            panel.value = name === "focus" ? "camera" : "focus";
            document.getElementById(`tab-${panel.value}`)?.focus();
          }}
        >
          {PANEL_NAMES[name]}
        </button>
      ))}
    </div>
  );
}
