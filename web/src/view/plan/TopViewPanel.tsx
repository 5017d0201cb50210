/** The set from above, beside the picture: the camera, what is sharp, and the focus points, to scale. */

import type { JSX } from "preact";
import { useLayoutEffect, useRef, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import { PLAN_UPS, type PlanUp } from "../../editor/remembered";
import type { Session } from "../../editor/session";
import { formatDistance, formatMark, type LengthUnit } from "../../model/distance";
import { saidOf } from "../../model/lens";
import type { Readout } from "../../model/shot";
import { gridOf, type Sheet, type TopView } from "../../model/top_view";
import { Radios } from "../controls/Radios";
import { useSize } from "../hooks";
import { Icon } from "../icons";
import { trim } from "../numbers";
import { FocusHandle } from "./FocusHandle";
import { CutLabels } from "./CutLabels";
import { GRID_PX, PlanDrawing } from "./PlanDrawing";
import { PlanMarker } from "./PlanMarker";
import { planPoints, withMoved, type Moved } from "./points";
import { moveByKey, pan, useSheet, useWheel, zoomBy, zoomByKey, ZOOM_STEP } from "./sheet";

const UP_NAMES: Readonly<Record<PlanUp, string>> = { camera: "Camera", north: "North" };
const UP_TITLES: Readonly<Record<PlanUp, string>> = {
  camera: "The camera looks up in the drawing",
  north: "The north of the world (−Z, in a stage with Z up +Y) is up in the drawing",
};

export function TopViewPanel({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const { unit, planUp } = editor.remembered;
  const { topView } = session;
  const place = useRef<HTMLDivElement>(null);
  const size = useSize(place);
  useLayoutEffect(() => {
    topView.isShown.value = true;
    return () => {
      topView.isShown.value = false;
    };
  }, [topView]);
  const [view, readout] = [topView.view.value, session.document.readout.value];
  const sheet = useSheet(session, view, size, planUp.value);
  useWheel(session, place, sheet);
  return (
    <section class="top-view" aria-label="Top view">
      <header class="top-view-head">
        <h2>Top view</h2>
        <Radios
          label="Way up"
          values={PLAN_UPS}
          value={planUp.value}
          names={UP_NAMES}
          titles={UP_TITLES}
          onChoose={(up) => (planUp.value = up)}
        />
        <div class="spacer" />
        <Zoom session={session} sheet={sheet} />
        <button
          type="button"
          class="button icon-only quiet"
          aria-label="Close the top view"
          title="Close the top view (V)"
          onClick={() => (editor.remembered.topView.value = "off")}
        >
          <Icon name="close" />
        </button>
      </header>
      <div
        class="plan"
        ref={place}
        role="group"
        tabIndex={0}
        aria-label="Plan: the arrow keys move it, + and − zoom, F shows all"
        onPointerDown={(down) => {
          if (sheet) pan(session, sheet, down);
        }}
        onKeyDown={(event) => {
          if (!sheet || event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
          const isOwn = event.target === event.currentTarget;
          if (isOwn ? moveByKey(session, sheet, event) : zoomByKey(session, sheet, event.key)) event.preventDefault();
        }}
      >
        {view && readout && sheet ? (
          <Plan editor={editor} session={session} view={view} readout={readout} sheet={sheet} unit={unit.value} />
        ) : (
          <Missing session={session} />
        )}
      </div>
      {view && readout && sheet && <Foot view={view} readout={readout} sheet={sheet} unit={unit.value} />}
    </section>
  );
}

interface PlanProps {
  readonly view: TopView;
  readonly readout: Readout;
  readonly sheet: Sheet;
  readonly unit: LengthUnit;
}

/** By which part of a square an arrow key moves a point. */
const STEP = 0.1;

function Plan({
  editor,
  session,
  view,
  readout,
  sheet,
  unit,
}: PlanProps & { editor: Editor; session: Session }): JSX.Element {
  const [moved, setMoved] = useState<Moved>(new Map());
  const points = planPoints(editor, session, view, moved);
  const stepM = STEP * gridOf(sheet, unit, GRID_PX).stepM;
  return (
    <>
      <PlanDrawing session={session} sheet={sheet} view={view} points={points} unit={unit} />
      <CutLabels sheet={sheet} view={view} readout={readout} points={points} unit={unit} />
      <FocusHandle session={session} sheet={sheet} view={view} readout={readout} unit={unit} />
      {points.map((shown) => {
        const identity = session.pointEdits.identityOf(shown.name);
        return (
          <PlanMarker
            key={identity}
            session={session}
            sheet={sheet}
            view={view}
            shown={shown}
            unit={unit}
            stepM={stepM}
            onDragged={(place) => {
              setMoved((before) => withMoved(before, identity, place));
            }}
          />
        );
      })}
    </>
  );
}

function Zoom({ session, sheet }: { session: Session; sheet: Sheet | null }): JSX.Element {
  const by = (factor: number) => (): void => {
    if (sheet) zoomBy(session, sheet, factor);
  };
  return (
    <div class="group" role="group" aria-label="Scale of the top view">
      <button
        type="button"
        class="button small icon-only"
        aria-label="Smaller"
        title="Smaller (−)"
        onClick={by(1 / ZOOM_STEP)}
      >
        −
      </button>
      <button
        type="button"
        class="button small icon-only"
        aria-label="Larger"
        title="Larger (+)"
        onClick={by(ZOOM_STEP)}
      >
        +
      </button>
      <button
        type="button"
        class="button small"
        title="Show the camera, all points and their ways (F on the plan)"
        onClick={() => (session.topView.sheet.value = null)}
      >
        Fit
      </button>
    </div>
  );
}

/** What there is to wait for. */
function Missing({ session: { document, topView } }: { session: Session }): JSX.Element {
  const isReading = topView.reading.value || document.reading.value;
  const state = isReading ? "Reading the set from above…" : "The camera could not be read.";
  return <p class="muted pad-all">{document.hasLens ? state : "There is no camera to show from above."}</p>;
}

/** The scale, and the lens in numbers. */
function Foot({ view, readout, sheet, unit }: PlanProps): JSX.Element {
  const { stepM } = gridOf(sheet, unit, GRID_PX);
  const across = ((Math.atan(view.edges[1]) - Math.atan(view.edges[0])) * 180) / Math.PI;
  const step = `${formatMark(stepM, unit)}${unit === "m" ? " m" : ""}`;
  return (
    <p class="plan-foot numbers">
      <span>
        Grid <b data-plan="grid">{step}</b>
      </span>
      <span>
        sharp from <b>{formatDistance(readout.nearM, unit)}</b> to <b>{formatDistance(readout.farM, unit)}</b>
      </span>
      <span>
        {saidOf(readout)}, gate {trim(view.gateMm, 1)} mm, {trim(across, 1)}° across
      </span>
    </p>
  );
}
