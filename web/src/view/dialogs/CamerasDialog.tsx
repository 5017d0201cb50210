/** What the cameras of the open shot see at the playhead's time, side by side. */

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { draftQuality, restQuality } from "../../model/quality";
import { primName, type CameraSummary } from "../../model/shot";
import { formatFrame } from "../../model/time";
import { complaintOf } from "../../net/errors";
import { TitledDialog } from "./TitledDialog";

/** Width of a picture, px of the page. */
const WIDTH_PX = 320;

export function CamerasDialog({ editor }: { editor: Editor }): JSX.Element {
  const session = editor.session.value;
  const close = (): void => {
    editor.camerasOpen.value = false;
  };
  const isOpen = editor.camerasOpen.value && session !== null;
  const title = isOpen ? `Cameras at frame ${formatFrame(session.playhead.time.value)}` : "Cameras";
  return (
    <TitledDialog name="cameras" title={title} isOpen={isOpen} close={close}>
      {session && <Tiles editor={editor} session={session} close={close} />}
    </TitledDialog>
  );
}

function Tiles({ editor, session, close }: { editor: Editor; session: Session; close: () => void }): JSX.Element {
  const { cameras } = session.shot;
  const pictures = usePictures(editor, session);
  const drawn = cameras.filter(({ path }) => pictures.has(path)).length;
  return (
    <>
      <p class="muted" role="status" data-drawn={drawn}>
        {drawn < cameras.length
          ? `Drawing ${drawn + 1} of ${cameras.length}…`
          : "Choose the camera that is looked through."}
      </p>
      <ul class="camera-tiles">
        {cameras.map((camera) => (
          <li key={camera.path}>
            <Tile
              camera={camera}
              seen={pictures.get(camera.path) ?? null}
              isChosen={camera.path === session.camera}
              onChoose={() => {
                close();
                void editor.lookThrough(camera.path);
              }}
            />
          </li>
        ))}
      </ul>
    </>
  );
}

/** A picture, or why there is none. */
type Seen = { readonly address: string } | { readonly refusal: string };

interface TileProps {
  readonly camera: CameraSummary;
  readonly seen: Seen | null;
  readonly isChosen: boolean;
  readonly onChoose: () => void;
}

function Tile({ camera: { path, aspect }, seen, isChosen, onChoose }: TileProps): JSX.Element {
  return (
    <button
      type="button"
      class="camera-tile"
      aria-pressed={isChosen}
      aria-label={`Look through ${primName(path)}`}
      title={path}
      data-camera={path}
      onClick={onChoose}
    >
      <span class="camera-picture" style={{ aspectRatio: aspect }}>
        {seen && "address" in seen && <img src={seen.address} alt="" />}
        {seen && "refusal" in seen && <span class="refusal">{seen.refusal}</span>}
      </span>
      <span>{primName(path)}</span>
    </button>
  );
}

/** Pictures by camera, drawn one after another, and anew where the time or the edits change. */
function usePictures(editor: Editor, session: Session): ReadonlyMap<string, Seen> {
  const [pictures, setPictures] = useState<ReadonlyMap<string, Seen>>(new Map());
  const { service } = editor;
  const { shot } = session;
  const time = session.playhead.time.value;
  const revision = session.document.revision.value;
  useEffect(() => {
    const abort = new AbortController();
    const addresses: string[] = [];
    const draw = async ({ path, aspect }: CameraSummary): Promise<Seen> => {
      const quality = draftQuality(restQuality(2 * WIDTH_PX, (2 * WIDTH_PX) / aspect));
      try {
        const picture = await service.frame({ shot: shot.id, camera: path }, time, quality, abort.signal);
        abort.signal.throwIfAborted();
        const address = URL.createObjectURL(picture);
        addresses.push(address);
        return { address };
      } catch (error: unknown) {
        return { refusal: complaintOf(error).message };
      }
    };
    const drawAll = async (): Promise<void> => {
      for (const camera of shot.cameras) {
        const seen = await draw(camera);
        if (abort.signal.aborted) return;
        setPictures((before) => new Map(before).set(camera.path, seen));
      }
    };
    setPictures(new Map());
    void drawAll();
    return () => {
      abort.abort();
      for (const address of addresses) URL.revokeObjectURL(address);
    };
  }, [service, shot, time, revision]);
  return pictures;
}
