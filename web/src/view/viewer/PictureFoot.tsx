/** The line below the picture: what a click does, and what the picture is. */

import type { JSX } from "preact";
import type { Displayed } from "../../editor/pictures";
import { TOOLS, type Tool } from "../../editor/picks";
import type { Session } from "../../editor/session";
import { Waiting } from "../controls/Waiting";
import { DrawButton } from "./Poster";
import { PullChoice } from "./PullChoice";
import { Radios } from "../controls/Radios";

export function PictureFoot({ session }: { session: Session }): JSX.Element {
  const canEdit = session.document.noEdits.value === null && session.document.hasLens;
  return (
    <footer class="picture-foot">
      {canEdit && <Tools session={session} />}
      {canEdit && session.picks.tool.value === "pull" && <PullChoice session={session} />}
      <PictureState session={session} />
    </footer>
  );
}

/** What a click on the picture does; the title of each tool has the keys that do so for one click. */
function Tools({ session: { picks, selectedName, gathers } }: { session: Session }): JSX.Element {
  const selected = selectedName.value;
  const names: Readonly<Record<Tool, string>> = {
    pull: "Pull focus",
    add: "Add point",
    move: selected === null ? "Move point" : `Move ${selected}`,
  };
  const titles: Readonly<Record<Tool, string>> = {
    pull: `A click pulls the focus there (Alt 1${gathers.value ? "; once with Shift" : ""})`,
    add: `A click adds a focus point there (Alt 2${gathers.value ? "" : "; once with Shift"})`,
    move: selected === null ? "Select a point to move it" : `A click moves ${selected} there (Alt 3; once with Alt)`,
  };
  return (
    <Radios
      label="What a click does"
      kind="tools"
      values={TOOLS}
      value={picks.tool.value}
      names={names}
      titles={titles}
      isDisabled={(tool) => tool === "move" && selected === null}
      onChoose={(tool) => {
        picks.choose(tool);
      }}
    />
  );
}

/** What is on screen, and the wait for the best picture. */
function PictureState({ session }: { session: Session }): JSX.Element {
  const { pictures, waits, playhead } = session;
  const shown = pictures.displayed.value;
  const wait = shown && !playhead.playing.value ? waits.of("picture") : null;
  return (
    <span class="picture-state">
      {wait && <Waiting wait={wait} />}
      {shown && pictures.stopped.value && (
        <span class="wait">
          Stopped <DrawButton session={session} />
        </span>
      )}
      {shown && <Scale session={session} />}
      {shown && <PictureFacts shown={shown} />}
    </span>
  );
}

/** How much the picture is enlarged, and the way to its pixels and back. */
function Scale({ session: { zoom } }: { session: Session }): JSX.Element {
  const scale = zoom.scale.value;
  const said = scale === null ? "Fit" : `${Math.round(100 * scale)} %`;
  return (
    <button
      type="button"
      class="button scale"
      aria-label={
        scale === null ? "Fit: the whole picture is shown; go to its pixels 1:1" : `${said}: show the whole picture`
      }
      title="Whole picture, or the pixels of the delivered one 1:1 (Z)"
      onClick={() => {
        zoom.toggle(null);
      }}
    >
      {said}
    </button>
  );
}

/** Size, rays and time of the picture on screen. */
function PictureFacts({ shown }: { shown: Displayed }): JSX.Element {
  const { width, height, stage, rays, share, tookMs, quality } = shown;
  const facts = [`${width} × ${height}`];
  if (rays > 0) facts.push(`${rays} rays`);
  if (stage === "final" && quality.motion > 1) facts.push(`${quality.motion} moments`);
  if (stage === "refining" && share > 0) facts.push(`${Math.round(100 * share)} %`);
  facts.push(tookMs < 1000 ? `${Math.round(tookMs)} ms` : `${(tookMs / 1000).toFixed(1)} s`);
  return (
    <>
      <span class="numbers" aria-live="off">
        {facts.join(" · ")}
      </span>
      <i class="stage" data-stage={stage} title={STAGES[stage]} aria-label={STAGES[stage]} role="img" />
    </>
  );
}

const STAGES: Readonly<Record<Displayed["stage"], string>> = {
  preview: "Quick preview",
  refining: "Getting better",
  final: "Exact: the picture that a file would hold",
};
