/** Focus mode, its settings, and the reason of the present focus. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { FOCUS_MODES, type FocusMode } from "../../model/shot";
import { useChosen } from "../controls/chosen";
import { importCurve } from "../file_choices";
import { ModeSettings } from "./FocusSettings";
import { Misses } from "./PointVerdict";
import { Section } from "./Section";
import { Radios } from "../controls/Radios";

const MODE_NAMES: Readonly<Record<FocusMode, string>> = {
  manual: "By hand",
  points: "Points",
  tiltPlane: "Tilt plane",
  surface: "Surface",
};
const MODE_TITLES: Readonly<Record<FocusMode, string>> = {
  manual: "The focus distance is yours to set and to key",
  points: "One distance, the best for all focus points",
  tiltPlane: "The lens tilts so that its plane of focus passes through the points",
  surface: "Each point has its own focus, and the picture runs smoothly between them: no lens does this",
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
  return (
    <button
      type="button"
      class="button small"
      title="Give the camera the focus curve of a file: .csv, .json, OpenTrackIO or .otio; it is focused by hand then (Alt I)"
      onClick={() => {
        importCurve(session);
      }}
    >
      Import…
    </button>
  );
}

function ModeChooser({ session, mode }: { session: Session; mode: FocusMode }): JSX.Element {
  const [shown, chosen] = useChosen(mode, session.document.fresh.value);
  return (
    <Radios
      label="Who focuses"
      kind="modes"
      values={FOCUS_MODES}
      value={shown}
      names={MODE_NAMES}
      titles={MODE_TITLES}
      onChoose={(choice) => {
        chosen.choose(choice, session.setFocusMode(choice));
      }}
    />
  );
}
