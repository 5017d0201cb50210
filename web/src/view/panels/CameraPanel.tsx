/** The camera: its body and framing, how it sees motion, its exposure, its film and its grade. */

import type { JSX } from "preact";
import { effect } from "@preact/signals";
import { useEffect } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { SHUTTER_TYPES, type FilmSettings, type Photography, type ShutterType } from "../../model/photography";
import { Choice, Options } from "../controls/Choice";
import { Edits } from "../controls/Edits";
import { ExposurePanel } from "./ExposurePanel";
import { FilmPanel, GradePanel } from "./FilmPanel";
import { GlassPanel } from "./GlassPanel";
import { PanelWait } from "../controls/PanelWait";
import { trim } from "../numbers";
import { Section } from "./Section";

export function CameraPanel({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const current = session.photography.current.value;
  useEffect(
    () =>
      effect(() => {
        // Last of all, since what draws pictures does it.
        if (session.settled.value) session.meter();
      }),
    [session],
  );
  if (!current) return <PanelWait session={session} what="camera" />;
  return (
    <>
      <ExposurePanel session={session} current={current} />
      <FilmPanel editor={editor} session={session} film={current.film} />
      <GradePanel session={session} film={current.film} />
      <Edits session={session}>
        <GlassPanel session={session} exposure={current.exposure} />
      </Edits>
      <Body editor={editor} session={session} film={current.film} />
      <Motion editor={editor} session={session} current={current} />
    </>
  );
}

const OTHER = "*";

function Body({ editor, session, film }: { editor: Editor; session: Session; film: FilmSettings }): JSX.Element {
  const { bodies } = editor.libraries.value;
  const mounted = bodies.find(({ title }) => title === film.body);
  const [width, height] = film.gateMm;
  return (
    <Section
      name="body"
      title="Body"
      aside={
        <span class="muted">
          {trim(width, 2)} × {trim(height, 2)} mm
        </span>
      }
    >
      <div class="fields">
        <Edits session={session}>
          <Choice
            label="Body"
            value={mounted?.name ?? OTHER}
            hint={mounted?.description}
            onChoose={(name) => {
              const body = bodies.find((one) => one.name === name);
              if (body) session.mounting.body(body);
            }}
          >
            {!mounted && <option value={OTHER}>{film.body || "The shot’s own gate"}</option>}
            {(["film", "digital"] as const).map((kind) => (
              <optgroup key={kind} label={kind === "film" ? "Film formats" : "Digital"}>
                {bodies
                  .filter((body) => body.kind === kind)
                  .map(({ name, title }) => (
                    <option key={name} value={name}>
                      {title}
                    </option>
                  ))}
              </optgroup>
            ))}
          </Choice>
        </Edits>
      </div>
    </Section>
  );
}

const SHUTTER_NAMES: Readonly<Record<ShutterType, string>> = {
  global: "All at once",
  rolling: "Rolling, line by line",
  focalPlane: "Focal plane, a slit",
  leaf: "Leaf, in the lens",
};

function Motion({ editor, session, current }: { editor: Editor; session: Session; current: Photography }): JSX.Element {
  const { motion } = editor.remembered;
  const still = current.exposure.shutterAngleDeg === 0;
  return (
    <Section name="motion" title="Motion">
      <div class="fields">
        <label
          class="switch-row"
          title="Looks at the shot at several moments while the shutter is open; the picture takes longer"
        >
          <input
            type="checkbox"
            class="switch"
            checked={motion.value === "on"}
            onChange={({ currentTarget: { checked } }) => (motion.value = checked ? "on" : "off")}
          />
          Show motion blur
          {still && motion.value === "on" && <span class="aside muted">the shutter is still</span>}
        </label>
        <Edits session={session}>
          <Choice
            label="Shutter"
            value={current.exposure.shutterType}
            onChoose={(chosen) => {
              const shutterType = SHUTTER_TYPES.find((type) => type === chosen) ?? "global";
              session.photography.setExposure("Shutter type", { shutterType }, current.exposure);
            }}
          >
            <Options values={SHUTTER_TYPES} names={SHUTTER_NAMES} />
          </Choice>
        </Edits>
      </div>
    </Section>
  );
}
