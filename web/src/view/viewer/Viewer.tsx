/** The picture in its surround: letterboxed, sharp to the device pixel, with the focus points on it. */

import { effect } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Displayed } from "../../editor/pictures";
import type { Session } from "../../editor/session";
import { MOTION_MOMENTS } from "../../model/quality";
import { formatFrame } from "../../model/time";
import { Aim } from "./Aim";
import { CameraBar } from "./CameraBar";
import { BurnIn } from "./BurnIn";
import { Compare } from "./Compare";
import { ZoomedFrame } from "./Frame";
import { Guides, MeterSpot } from "./Guides";
import { Icon } from "../icons";
import { Drawings } from "../notes/Drawings";
import { NotesPanel } from "../notes/NotesPanel";
import { TopViewPanel } from "../plan/TopViewPanel";
import { ScopesPanel } from "../scopes/ScopesPanel";
import { Empty } from "./Empty";
import { ExposureOverlay } from "./ExposureOverlay";
import { FocusOverlay, hasOverlay, useFocusMaps } from "./FocusOverlay";
import { Loupe } from "./Loupe";
import { Markers, Picking } from "./Markers";
import { FirstPicture, useKeptPosters } from "./Poster";
import { Probe } from "./Probe";
import { PictureFoot } from "./PictureFoot";
import { Waits } from "./Waits";
import { isLate, Wanted } from "./Wanted";

export function Viewer({ editor }: { editor: Editor }): JSX.Element {
  const session = editor.session.value;
  const isSeenFromAbove = session !== null && editor.remembered.topView.value === "on";
  const isMeasured = editor.remembered.scopes.value === "on";
  const hasNotes = session?.frameNotes.isShown.value === true;
  const shown = { "with-plan": isSeenFromAbove, "with-scopes": session !== null && isMeasured, "with-notes": hasNotes };
  const parts = Object.entries(shown).filter(([, isShown]) => isShown);
  const classes = ["viewer", `surround-${editor.remembered.surround.value}`, ...parts.map(([name]) => name)].join(" ");
  return (
    <main class={classes} aria-label="Picture">
      {session ? (
        <div class="viewer-parts">
          <Picture editor={editor} session={session} />
          <NotesPanel session={session} />
          {isSeenFromAbove && <TopViewPanel editor={editor} session={session} />}
        </div>
      ) : (
        <Empty editor={editor} />
      )}
      {session && isMeasured && <ScopesPanel editor={editor} session={session} />}
      {session && <Waits editor={editor} />}
      <HeldBack editor={editor} />
      <Complaint editor={editor} />
      {session && <PictureFoot session={session} />}
    </main>
  );
}

function Picture({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const motion = editor.remembered.motion.value === "on" ? MOTION_MOMENTS : 1;
  useLayoutEffect(() => {
    session.motion.value = motion;
  }, [session, motion]);
  useFocusMaps(editor, session);
  useKeptPosters(editor, session);
  return (
    <ZoomedFrame
      session={session}
      aspect={session.aspect}
      deliveredPx={Number(editor.remembered.delivery.value)}
      onPointerMove={(event) => (session.pointer.value = placeOf(event))}
      onPointerLeave={() => (session.pointer.value = null)}
      beside={
        <>
          <Busy editor={editor} session={session} />
          <CameraBar session={session} />
        </>
      }
    >
      <Canvas session={session} />
      {hasOverlay(editor) && <FocusOverlay editor={editor} session={session} />}
      <ExposureOverlay editor={editor} session={session} />
      <Compare editor={editor} session={session} />
      <FirstPicture editor={editor} session={session} />
      <Wanted session={session} />
      {session.pictures.refusal !== null && <p class="no-picture">{session.pictures.refusal}</p>}
      <Guides editor={editor} session={session} />
      <BurnIn editor={editor} session={session} />
      <MeterSpot editor={editor} session={session} />
      {editor.remembered.markers.value === "on" && <Markers editor={editor} session={session} />}
      <Aim session={session} />
      <Probe editor={editor} session={session} />
      <Picking session={session} />
      <Drawings session={session} />
      <Loupe session={session} />
    </ZoomedFrame>
  );
}

function Canvas({ session }: { session: Session }): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(
    () =>
      effect(() => {
        const shown = session.pictures.displayed.value;
        if (shown && canvas.current) draw(shown, canvas.current);
      }),
    [session],
  );
  const shown = session.pictures.displayed.value;
  return (
    <canvas
      ref={canvas}
      role="img"
      class={`${session.document.noEdits.value === null ? "" : "read-only"} ${isLate(session) ? "late" : ""}`}
      title={session.document.noEdits.value ?? undefined}
      aria-label={shown ? `Frame ${formatFrame(shown.time)} of ${session.shot.name}` : "No frame yet"}
      data-settled={session.settled.value}
      data-stage={shown?.stage}
      data-unsaved={shown !== null && shown.unsaved.length > 0}
      data-time={shown?.time}
      data-revision={shown?.revision}
      data-edits={session.document.fresh.value ? session.document.history.value.revision : undefined}
      onPointerDown={(event) => {
        const isPull = event.button === 0 && session.picks.toolWith(event) === "pull";
        const canPull = session.document.hasLens && session.document.noEdits.value === null;
        session.pulls.aiming.value = isPull && canPull && session.picks.picking.value === null;
      }}
      onPointerLeave={() => (session.pulls.aiming.value = false)}
      onPointerCancel={() => (session.pulls.aiming.value = false)}
      onClick={(event) => {
        const tool = session.picks.toolWith(event);
        void session.picks.click(placeOf(event), tool).finally(() => (session.pulls.aiming.value = false));
      }}
    />
  );
}

function draw({ bitmap, quality: { width, height } }: Displayed, canvas: HTMLCanvasElement): void {
  const context = canvas.getContext("2d", { alpha: false });
  if (!context) return;
  canvas.width = width;
  canvas.height = height;
  // A preview is smaller than the place that it fills; browsers enlarge more smoothly here than by style.
  context.imageSmoothingQuality = "high";
  context.drawImage(bitmap, 0, 0, width, height);
}

/** Where in the picture a pointer is: 0 to 1 from its top left corner. */
function placeOf(event: MouseEvent): [number, number] {
  const frame = (event.currentTarget as Element).getBoundingClientRect();
  return [(event.clientX - frame.left) / frame.width, (event.clientY - frame.top) / frame.height];
}

/** Progress of the work under way, and of a picture that is refined. */
function Busy({ editor, session }: { editor: Editor; session: Session }): JSX.Element | null {
  const refining = session.pictures.busy.value;
  const busy = refining || session.document.pending.value > 0 || editor.opening.value !== null;
  if (!busy || session.playhead.playing.value) return null;
  const shown = session.pictures.displayed.value;
  const share = refining && shown?.stage === "refining" ? shown.share : 0;
  if (share === 0) return <div class="busy" role="progressbar" aria-label="Rendering" />;
  const done = Math.round(100 * share);
  return (
    <div class="refining" role="progressbar" aria-label="Refining" aria-valuenow={done} style={{ "--done": share }} />
  );
}

/** Why nothing comes, until the service takes more requests. */
function HeldBack({ editor }: { editor: Editor }): JSX.Element | null {
  const waiting = editor.waiting.value;
  if (waiting === null || editor.complaint.value) return null;
  return (
    <div class="complaint waiting" role="status">
      <p>
        <strong>Waiting for the service.</strong> {waiting} The page tries again by itself.
      </p>
    </div>
  );
}

/** The last error in one line, with a remedy. */
function Complaint({ editor }: { editor: Editor }): JSX.Element | null {
  const complaint = editor.complaint.value;
  if (!complaint) return null;
  return (
    <div class="complaint" role="alert">
      <p>
        <strong>{complaint.message}</strong> {complaint.advice}
      </p>
      {complaint.remedy && (
        <button
          type="button"
          class="button"
          onClick={() => {
            if (complaint.remedy === "signIn") editor.identity.askAgain();
            else editor.retry();
          }}
        >
          {complaint.remedy === "signIn" ? "Sign in" : "Try again"}
        </button>
      )}
      <button
        type="button"
        class="button icon-only quiet"
        aria-label="Dismiss"
        onClick={() => (editor.complaint.value = null)}
      >
        <Icon name="close" />
      </button>
    </div>
  );
}
