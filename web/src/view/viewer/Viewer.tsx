/** The picture in its surround: letterboxed, sharp to the device pixel, with the focus points on it. */

import { effect } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Displayed } from "../../editor/pictures";
import type { Session } from "../../editor/session";
import { letterbox, MOTION_MOMENTS } from "../../model/quality";
import { formatFrame } from "../../model/time";
import { Aim } from "./Aim";
import { Guides, MeterSpot } from "./Guides";
import { usePixelRatio, useSize } from "../hooks";
import { Icon } from "../icons";
import { FocusOverlay, hasOverlay, useFocusMaps } from "./FocusOverlay";
import { Markers, Picking } from "./Markers";
import { Probe } from "./Probe";
import { PictureFoot } from "./PictureFoot";
import { UploadButton } from "../dialogs/Shots";
import { isLate, Wanted } from "./Wanted";

export function Viewer({ editor }: { editor: Editor }): JSX.Element {
  const session = editor.session.value;
  return (
    <main class={`viewer surround-${editor.remembered.surround.value}`} aria-label="Picture">
      {session ? <Picture editor={editor} session={session} /> : <Empty editor={editor} />}
      <Waiting editor={editor} />
      <Complaint editor={editor} />
      {session && <PictureFoot session={session} />}
    </main>
  );
}

function Empty({ editor }: { editor: Editor }): JSX.Element {
  const waiting = editor.opening.value !== null || (editor.library.shots.value === null && !editor.complaint.value);
  if (waiting)
    return (
      <div class="empty">
        <p>Opening the shot…</p>
      </div>
    );
  return (
    <div class="empty">
      <h2>No shot is open</h2>
      <p>Drop a USD file here, or choose one. A .zip may hold a shot with all that it references.</p>
      <UploadButton editor={editor} label="Add a shot" />
    </div>
  );
}

function Picture({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const surround = useRef<HTMLDivElement>(null);
  const size = useSize(surround);
  const ratio = usePixelRatio();
  const box = snapToPixels(letterbox(size.width, size.height, session.aspect), ratio);
  const { width, height } = box;
  useLayoutEffect(() => {
    if (width > 0 && height > 0)
      session.box.value = { width: Math.round(width * ratio), height: Math.round(height * ratio) };
  }, [session, width, height, ratio]);
  const motion = editor.remembered.motion.value === "on" ? MOTION_MOMENTS : 1;
  useLayoutEffect(() => {
    session.motion.value = motion;
  }, [session, motion]);
  useFocusMaps(editor, session);
  const style = { left: `${box.left}px`, top: `${box.top}px`, width: `${width}px`, height: `${height}px` };
  return (
    <div class="surround" ref={surround}>
      <div
        class="picture"
        style={style}
        onPointerMove={(event) => (session.pointer.value = placeOf(event))}
        onPointerLeave={() => (session.pointer.value = null)}
      >
        <Canvas session={session} />
        {hasOverlay(editor) && <FocusOverlay editor={editor} session={session} />}
        <Wanted session={session} />
        {session.pictures.refusal !== null && <p class="no-picture">{session.pictures.refusal}</p>}
        <Guides editor={editor} session={session} />
        <MeterSpot editor={editor} session={session} />
        {editor.remembered.markers.value === "on" && <Markers editor={editor} session={session} />}
        <Aim session={session} />
        <Probe editor={editor} session={session} />
        <Picking session={session} />
      </div>
      <Busy editor={editor} session={session} />
    </div>
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

/** Edges on device pixels, so that a picture of that many pixels is shown one to one. */
function snapToPixels<Box extends Record<"left" | "top" | "width" | "height", number>>(box: Box, ratio: number): Box {
  const snap = (value: number): number => Math.round(value * ratio) / ratio;
  const even = (value: number): number => (Math.floor((value * ratio) / 2) * 2) / ratio;
  return { ...box, left: snap(box.left), top: snap(box.top), width: even(box.width), height: even(box.height) };
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

/** What is waited for, until the service takes more requests. */
function Waiting({ editor }: { editor: Editor }): JSX.Element | null {
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
