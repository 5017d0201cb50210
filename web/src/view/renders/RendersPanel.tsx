/** Renders: a new one, and the list of those that were sent. */

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { Renders } from "../../editor/renders";
import type { Render } from "../../model/renders";
import { PolledChanges, ToldChanges } from "../../net/render_changes";
import type { RendersPanelProps } from "../dialogs/RendersDialog";
import { Icon } from "../icons";
import { NewRender } from "./NewRender";
import { RenderRow } from "./RenderRow";
import "../style/renders.css";

export function RendersPanel({ editor, close }: RendersPanelProps): JSX.Element {
  const [renders] = useState(() => {
    const service = editor.service.renders;
    return new Renders(service, new ToldChanges(() => service.changes(), new PolledChanges(document)));
  });
  const [isOfShot, setOfShot] = useState(false);
  useEffect(() => renders.follow(), [renders]);
  const session = editor.session.value;
  const isNew = editor.rendersView.value === "new" && session !== null;
  const refusal = session === null ? "No shot is open." : editor.identity.noPictures.value;
  const endNew = (): void => {
    editor.rendersView.value = "list";
  };
  return (
    <>
      <header class="renders-head">
        <h2>Renders</h2>
        {session && (
          <label class="check" title={`Only renders of ${session.shot.name}`}>
            <input
              type="checkbox"
              class="switch"
              checked={isOfShot}
              onChange={({ currentTarget }) => {
                setOfShot(currentTarget.checked);
              }}
            />
            Only this shot
          </label>
        )}
        <button
          type="button"
          class={isNew ? "button" : "button primary"}
          aria-expanded={isNew}
          disabled={refusal !== null}
          title={refusal ?? "Sends many frames of this shot to be drawn, one after the other"}
          onClick={() => (editor.rendersView.value = isNew ? "list" : "new")}
        >
          Render…
        </button>
        <button type="button" class="button icon-only" aria-label="Close" onClick={close}>
          <Icon name="close" />
        </button>
      </header>
      <div class="renders-body">
        {isNew && (
          <NewRender
            key={`${session.shot.id} ${session.camera ?? ""}`}
            editor={editor}
            session={session}
            renders={renders}
            onSent={(render) => {
              renders.add(render);
              endNew();
            }}
            onCancel={endNew}
          />
        )}
        <Told renders={renders} />
        <List renders={renders} editor={editor} shot={isOfShot ? (session?.shot.id ?? null) : null} />
      </div>
    </>
  );
}

/** What was refused, and whether the list is old. */
function Told({ renders }: { renders: Renders }): JSX.Element {
  const [refusal, complaint] = [renders.refusal.value, renders.complaint.value];
  return (
    <>
      <p class="renders-told" role="alert">
        {refusal}
      </p>
      <p class="renders-told" role="status">
        {complaint !== null && `The list may be old. ${complaint}`}
      </p>
    </>
  );
}

interface ListProps extends Pick<RendersPanelProps, "editor"> {
  readonly renders: Renders;
  /** Shot whose renders are shown; null for all. */
  readonly shot: string | null;
}

function List({ renders, editor, shot }: ListProps): JSX.Element {
  const all = renders.all.value;
  if (all === null) return <p class="muted renders-none">Listing the renders…</p>;
  const shown = shot === null ? all : all.filter((render) => render.shot === shot);
  const refusal = editor.identity.noPictures.value;
  return (
    <>
      {shown.length === 0 && <p class="muted renders-none">{nothingOf(all, renders.hasOlder.value)}</p>}
      <ul class="render-list" aria-label="Renders, the newest first">
        {shown.map((render) => (
          <RenderRow
            key={render.id}
            renders={renders}
            render={render}
            refusal={refusal}
            frameAddress={(frame, format) => editor.service.renders.frameAddress(render.id, frame, format)}
            thumbnailAddress={(frame) => editor.service.renders.thumbnailAddress(render.id, frame)}
            productAddress={(product) => editor.service.renders.productAddress(render.id, product)}
            reportAddress={(format) => editor.service.renders.reportAddress(render.id, format)}
            readLog={(frame, attempt, abort) => editor.service.renders.log(render.id, frame, attempt, abort)}
          />
        ))}
      </ul>
      {renders.hasOlder.value && (
        <button type="button" class="button renders-older" onClick={() => void renders.showOlder()}>
          Show older ones
        </button>
      )}
    </>
  );
}

function nothingOf(all: readonly Render[], hasOlder: boolean): string {
  if (all.length === 0) return "Nothing was rendered yet. A render draws many frames of a shot, one after the other.";
  return hasOlder ? "None of the newest renders is of this shot." : "No render is of this shot.";
}
