/** f-number, focal length and focus distance, and the depth of field that they give. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { formatDistance, parseDistance, type LengthUnit } from "../../model/distance";
import { FOCAL_LENGTHS_MM, FOCUS_DISTANCES_M } from "../../model/scale";
import { LENS_SLIDERS } from "../../model/settings.gen";
import type { Readout } from "../../model/shot";
import { DepthStrip } from "../viewer/DepthStrip";
import { LensChooser } from "../dialogs/LensChooser";
import { trim } from "../numbers";
import { Setting } from "../controls/Setting";
import { StopSetting } from "../controls/StopSetting";
import { Edits } from "../controls/Edits";
import { PanelWait } from "../controls/PanelWait";
import { Reading } from "../controls/Reading";
import { Section } from "./Section";

interface LensPanelProps {
  readonly editor: Editor;
  readonly session: Session;
  readonly unit: LengthUnit;
}

export function LensPanel({ editor, session, unit }: LensPanelProps): JSX.Element {
  const readout = session.document.readout.value;
  return (
    <Section name="lens" title="Lens">
      {readout ? (
        <>
          <LensChooser editor={editor} session={session} readout={readout} />
          <Edits session={session}>
            <LensFields session={session} readout={readout} unit={unit} />
          </Edits>
          <DepthOfField session={session} readout={readout} unit={unit} />
        </>
      ) : (
        <PanelWait session={session} what="lens" />
      )}
    </Section>
  );
}

const STOP_HINT = "f-number and T-stop of the lens, in thirds of a stop; hold Alt for anything between, or type it";

function LensFields({ session, readout, unit }: { session: Session; readout: Readout; unit: LengthUnit }): JSX.Element {
  const fresh = session.document.fresh.value;
  const keys = session.document.focusSettings.value?.keys ?? {};
  const exposure = session.photography.current.value?.exposure;
  const pointsSetStop = session.pointsSetStop.value;
  return (
    <div class="fields">
      <StopSetting
        session={session}
        setting="fStop"
        keys={keys}
        value={readout.fStop}
        marking={exposure?.stopMarking ?? "f"}
        transmittance={exposure?.transmittance ?? 1}
        fresh={fresh}
        disabled={pointsSetStop}
        hint={pointsSetStop ? "The focus points set it" : STOP_HINT}
        startDrag={() => session.dragLens("f-number", "fStop", readout)}
      />
      <Setting
        session={session}
        setting="focalLengthMm"
        keys={keys}
        label={LENS_SLIDERS.focalLengthMm.label}
        value={readout.focalLengthMm}
        scale={FOCAL_LENGTHS_MM}
        fresh={fresh}
        example="50 mm"
        format={(value) => `${trim(value, 1)} mm`}
        parse={(text) => parseNumber(text, /^([\d.]+)\s*(?:mm)?$/i)}
        startDrag={() => session.dragLens("focal length", "focalLengthMm", readout)}
      />
      <Setting
        session={session}
        setting="focusDistanceM"
        keys={keys}
        label={LENS_SLIDERS.focusDistanceM.label}
        value={readout.focusDistanceM}
        scale={FOCUS_DISTANCES_M}
        fresh={fresh}
        example={unit === "m" ? "2.5, 85 cm or ∞" : "8′ 2″ or ∞"}
        format={(value) => formatDistance(value, unit)}
        parse={(text) => parseDistance(text, unit)}
        startDrag={() => session.dragLens("focus distance", "focusDistanceM", readout)}
      />
    </div>
  );
}

function DepthOfField({
  session,
  readout,
  unit,
}: {
  session: Session;
  readout: Readout;
  unit: LengthUnit;
}): JSX.Element {
  return (
    <div class="dof">
      <h3>Depth of field</h3>
      <DepthStrip
        readout={readout}
        points={session.document.points.value}
        selected={session.selected.value}
        unit={unit}
      />
      <dl class="readout">
        <Reading of="reading" name="Near" value={formatDistance(readout.nearM, unit)} />
        <Reading of="reading" name="Far" value={formatDistance(readout.farM, unit)} />
        <Reading of="reading" name="Depth" value={formatDistance(readout.farM - readout.nearM, unit)} />
        <Reading of="reading" name="Hyperfocal" value={formatDistance(readout.hyperfocalM, unit)} />
      </dl>
    </div>
  );
}

function parseNumber(text: string, pattern: RegExp): number | null {
  const value = Number(pattern.exec(text.trim().replace(",", "."))?.[1] ?? NaN);
  return value > 0 && Number.isFinite(value) ? value : null;
}
