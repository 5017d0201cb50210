/** Focus mode, its settings, and the reason of the present focus. */

import type { JSX } from "preact";
import { useRef } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { FOCUS_MODES, type FocusMode } from "../../model/shot";
import { useChosen } from "../controls/chosen";
import { ModeSettings } from "./FocusSettings";
import { Misses } from "./PointVerdict";
import { Section } from "./Section";

const MODES: Readonly<Record<FocusMode, readonly [name: string, does: string]>> = {
  manual: ["By hand", "The focus distance is yours to set and to key"],
  points: ["Points", "One distance, the best for all focus points"],
  tiltPlane: ["Tilt plane", "The lens tilts so that its plane of focus passes through the points"],
  surface: ["Surface", "Each point has its own focus, and the picture runs smoothly between them: no lens does this"],
};

export function FocusPanel({ editor, session }: { editor: Editor; session: Session }): JSX.Element | null {
  const readout = session.document.readout.value;
  const settings = session.document.focusSettings.value;
  if (!readout || !settings) return null;
  return (
    <Section name="focus" title="Focus" aside={<CurveImport session={session} />}>
      <div class="fields">
        <ModeChooser session={session} mode={readout.focusMode} />
        <p class="reason" title={readout.reason}>
          {readout.reason}
        </p>
        {readout.note !== "" && (
          <p class="reason remark" role="status">
            {readout.note}
          </p>
        )}
        <Misses editor={editor} session={session} readout={readout} />
        <ModeSettings session={session} readout={readout} settings={settings} />
      </div>
    </Section>
  );
}

/** A focus curve of another tool, from a file. */
function CurveImport({ session }: { session: Session }): JSX.Element {
  const file = useRef<HTMLInputElement>(null);
  return (
    <>
      <button
        type="button"
        class="button small"
        title="Give the camera the focus curve of a file: .csv, .json, OpenTrackIO or .otio; it is focused by hand then"
        onClick={() => file.current?.click()}
      >
        Import…
      </button>
      <input
        ref={file}
        type="file"
        hidden
        aria-label="Focus curve file"
        accept=".csv,.json,.otio"
        onChange={({ currentTarget }) => {
          const chosen = currentTarget.files?.[0];
          if (chosen) session.mounting.curve(chosen);
          currentTarget.value = "";
        }}
      />
    </>
  );
}

function ModeChooser({ session, mode }: { session: Session; mode: FocusMode }): JSX.Element {
  const [shown, chosen] = useChosen(mode, session.document.fresh.value);
  return (
    <div class="group modes" role="radiogroup" aria-label="Who focuses">
      {FOCUS_MODES.map((choice) => (
        <button
          key={choice}
          type="button"
          class="button small"
          role="radio"
          aria-checked={shown === choice}
          title={MODES[choice][1]}
          onClick={() => {
            chosen.choose(choice, session.setFocusMode(choice));
          }}
        >
          {MODES[choice][0]}
        </button>
      ))}
    </div>
  );
}
