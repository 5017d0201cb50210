/** What is shown until the first picture of a shot is there: how it looked last time, dimmed, and a sentence about what comes. */

import { effect } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Displayed } from "../../editor/pictures";
import type { Session } from "../../editor/session";
import type { Wait } from "../../editor/waits";
import { saidOf } from "../../model/lens";
import { Waiting } from "../controls/Waiting";
import { Frame } from "./Frame";

/** Width of kept posters: they are shown blurred. */
const WIDTH_PX = 320;
/** How long a best picture is on screen before it is kept, ms: a hand that steps through frames is not held up. */
const REST_MS = 300;

/** A shot that is being opened while none is open. */
export function OpeningPoster({ editor, wait }: { editor: Editor; wait: Wait }): JSX.Element {
  const { shot = "", camera = null } = editor.opening.value ?? {};
  const poster = editor.posterOf(shot, camera);
  return (
    <Frame aspect={poster?.aspect ?? 16 / 9}>
      <Poster image={poster?.image ?? null}>
        <Waiting wait={wait} said={openingOf(nameOf(editor, shot), poster?.lens)} />
      </Poster>
    </Frame>
  );
}

/** An open shot whose first picture is on its way, or was stopped. */
export function FirstPicture({ editor, session }: { editor: Editor; session: Session }): JSX.Element | null {
  const { pictures, shot, camera, waits } = session;
  if (pictures.displayed.value !== null || pictures.refusal !== null) return null;
  const poster = editor.posterOf(shot.id, camera);
  const readout = session.document.readout.value;
  const lens = readout && session.document.hasLens ? saidOf(readout) : poster?.lens;
  const wait = waits.of("picture");
  const said = openingOf(shot.name, lens);
  const isOver = pictures.stopped.value || editor.complaint.value !== null;
  return (
    <Poster image={poster?.image ?? null}>
      {wait ? (
        <Waiting wait={wait} said={said} />
      ) : isOver ? (
        <span class="wait">
          There is no picture of {shot.name} yet. <DrawButton session={session} />
        </span>
      ) : (
        <span class="wait">{said}…</span>
      )}
    </Poster>
  );
}

/** Draws a picture that was stopped. */
export function DrawButton({ session }: { session: Session }): JSX.Element {
  return (
    <button
      type="button"
      class="button small"
      onClick={() => {
        session.pictures.resume();
      }}
    >
      Draw it
    </button>
  );
}

function Poster({ image, children }: { image: string | null; children: JSX.Element }): JSX.Element {
  return (
    <div class="poster">
      {image !== null && <img src={image} alt="" />}
      <div class="poster-said">{children}</div>
    </div>
  );
}

function openingOf(name: string, lens: string | undefined): string {
  return `${name}: opening${lens ? ` through ${lens}` : ""}`;
}

function nameOf(editor: Editor, shot: string): string {
  return editor.library.shots.value?.find(({ id }) => id === shot)?.name ?? shot;
}

/** Keeps a poster of each best picture that is shown. */
export function useKeptPosters(editor: Editor, session: Session): void {
  useEffect(
    () =>
      effect(() => {
        const shown = session.pictures.displayed.value;
        if (!shown || !session.settled.value) return;
        const timer = setTimeout(() => {
          keepPoster(editor, session, shown);
        }, REST_MS);
        return () => {
          clearTimeout(timer);
        };
      }),
    [editor, session],
  );
}

function keepPoster(editor: Editor, session: Session, shown: Displayed): void {
  const readout = session.document.readout.peek();
  const lens = readout && session.document.hasLens ? saidOf(readout) : "";
  const image = smallPicture(shown);
  if (image !== null)
    editor.keepPoster({ shot: session.shot.id, camera: session.camera, lens, image, aspect: session.aspect });
}

/** A picture as a data URL; null where the browser makes none. */
function smallPicture({ bitmap }: Displayed): string | null {
  const canvas = document.createElement("canvas");
  canvas.width = WIDTH_PX;
  canvas.height = Math.max(1, Math.round((WIDTH_PX * bitmap.height) / bitmap.width));
  const context = canvas.getContext("2d", { alpha: false });
  if (!context) return null;
  context.imageSmoothingQuality = "high";
  context.drawImage(bitmap, 0, 0, canvas.width, canvas.height);
  return canvas.toDataURL("image/jpeg", 0.6);
}
