/** The shots, on the left: open one, send one, remove one. */

import type { JSX } from "preact";
import { effect } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Upload } from "../../editor/library";
import type { Wait } from "../../editor/waits";
import type { Note, ShotSummary } from "../../model/shot";
import { Company } from "../company/Company";
import { Splitter } from "../controls/Splitter";
import { Waiting } from "../controls/Waiting";
import { Icon } from "../icons";
import { formatBytes } from "../numbers";
import { Trash } from "./Trash";

const ACCEPTED = ".usd,.usda,.usdc,.usdz,.zip";

export function Shots({ editor }: { editor: Editor }): JSX.Element {
  const shots = editor.library.shots.value;
  const side = useRef<HTMLElement>(null);
  return (
    <nav ref={side} class="side shots" aria-label="Shots">
      <Splitter layout={editor.layout} panel="shots" label="Width of the shots" of={side} />
      <div class="panel">
        <div class="panel-head">
          <h2>Shots</h2>
          <UploadButton editor={editor} />
        </div>
        {shots === null && <p class="muted pad">Listing the shots…</p>}
        <ul class="shot-list">
          {shots?.map((shot) => (
            <ShotRow key={shot.id} editor={editor} shot={shot} />
          ))}
          {editor.library.uploads.value.map((upload) => (
            <UploadRow
              key={upload.id}
              upload={upload}
              onChoose={(root) => void editor.chooseRoot(upload, root)}
              onDismiss={() => {
                editor.library.dismiss(upload.id);
              }}
            />
          ))}
        </ul>
        <Trash editor={editor} />
        <p class="drop-hint" hidden={editor.identity.noEdits.value !== null}>
          Drop a .usda, .usdc or .usdz file anywhere, or a .zip of a shot with what it references.
        </p>
      </div>
    </nav>
  );
}

export function UploadButton({ editor, label }: { editor: Editor; label?: string }): JSX.Element {
  const refusal = editor.identity.noEdits.value;
  return (
    <button
      type="button"
      class={label ? "button primary" : "button icon-only"}
      aria-label="Add a shot"
      title={refusal ?? "Add a shot (Ctrl O)"}
      disabled={refusal !== null}
      onClick={() => (editor.fileRequests.value += 1)}
    >
      <Icon name="plus" />
      {label}
    </button>
  );
}

/** The browser's dialog for the files of shots; it opens when one is asked for. */
export function ShotFiles({ editor }: { editor: Editor }): JSX.Element {
  const input = useRef<HTMLInputElement>(null);
  useEffect(
    () =>
      effect(() => {
        if (editor.fileRequests.value > 0) input.current?.click();
      }),
    [editor],
  );
  return (
    <input
      ref={input}
      type="file"
      accept={ACCEPTED}
      multiple
      hidden
      aria-label="File of a shot"
      onChange={(event) => {
        const files = [...(event.currentTarget.files ?? [])];
        event.currentTarget.value = ""; // so that the same file can be sent again
        void editor.upload(files);
      }}
    />
  );
}

function ShotRow({ editor, shot }: { editor: Editor; shot: ShotSummary }): JSX.Element {
  const [asking, setAsking] = useState(false);
  const session = editor.session.value;
  const isOpen = session?.shot.id === shot.id;
  const opening = editor.opening.value?.shot === shot.id;
  const refusal = editor.identity.noEdits.value;
  return (
    <li class={isOpen ? "shot open" : "shot"}>
      <div class="shot-row">
        <button
          type="button"
          class="shot-open"
          aria-current={isOpen ? "true" : undefined}
          onClick={() => void editor.open(shot.id)}
        >
          <span class="name">{shot.name}</span>
          <span class="muted">
            {opening ? "Opening…" : `${plural(shot.fileCount, "file")} · ${formatBytes(shot.sizeBytes)}`}
          </span>
        </button>
        <button
          type="button"
          class="button icon-only quiet"
          aria-label={`Remove ${shot.name}`}
          title={refusal ?? "Remove this shot"}
          disabled={refusal !== null}
          onClick={() => {
            setAsking(!asking);
          }}
        >
          <Icon name="trash" />
        </button>
      </div>
      {asking && (
        <div class="ask" role="group" aria-label={`Remove ${shot.name}?`}>
          <span>Remove it and its edits?</span>
          <button
            type="button"
            class="button"
            onClick={() => {
              setAsking(false);
              void editor.remove(shot.id);
            }}
          >
            Remove
          </button>
          <button
            type="button"
            class="button"
            onClick={() => {
              setAsking(false);
            }}
          >
            Keep
          </button>
        </div>
      )}
      {shot.quarantine !== null && <Quarantine editor={editor} shot={shot} reason={shot.quarantine} />}
      {isOpen && <Company editor={editor} session={session} />}
      {isOpen && session.notes.value.length > 0 && <Notes notes={session.notes.value} />}
    </li>
  );
}

function Quarantine({ editor, shot, reason }: { editor: Editor; shot: ShotSummary; reason: string }): JSX.Element {
  const refusal = editor.identity.noEdits.value;
  return (
    <div class="ask" role="group" aria-label={`${shot.name} is in quarantine`}>
      <span>In quarantine: {reason}.</span>
      <button
        type="button"
        class="button"
        disabled={refusal !== null}
        title={refusal ?? "Lets it be opened again; it goes back where it ends three more workers"}
        onClick={() => void editor.release(shot.id)}
      >
        Release
      </button>
    </div>
  );
}

function Notes({ notes }: { notes: readonly Note[] }): JSX.Element {
  return (
    <details class="notes">
      <summary>{plural(notes.length, "note")} on what is shown</summary>
      <ul>
        {notes.map((note) => (
          <li key={`${note.code} ${note.path}`}>
            {note.message} {!note.message.includes(note.path) && <span class="muted">{note.path}</span>}
          </li>
        ))}
      </ul>
    </details>
  );
}

interface UploadRowProps {
  readonly upload: Upload;
  readonly onChoose: (root: string) => void;
  readonly onDismiss: () => void;
}

function UploadRow({ upload, onChoose, onDismiss }: UploadRowProps): JSX.Element {
  const { name, complaint, candidates, wait } = upload;
  return (
    <li class={complaint ? "shot upload refused" : "shot upload"}>
      <div class="shot-row">
        <div class="shot-open">
          <span class="name">{name}</span>
          {complaint ? (
            <span role="alert">
              {complaint.message} {complaint.advice}
            </span>
          ) : candidates.length > 0 ? (
            <span role="status">It holds {candidates.length} stages. Which one is the shot?</span>
          ) : (
            wait && <Sent wait={wait} />
          )}
        </div>
        {(complaint !== null || candidates.length > 0) && (
          <button type="button" class="button icon-only quiet" aria-label={`Dismiss ${name}`} onClick={onDismiss}>
            <Icon name="close" />
          </button>
        )}
      </div>
      {candidates.length > 0 && (
        <div class="roots" role="group" aria-label={`Stages of ${name}`}>
          {candidates.map((path) => (
            <button
              key={path}
              type="button"
              class="button"
              title={`Send ${name} again, with ${path} as its root`}
              onClick={() => {
                onChoose(path);
              }}
            >
              {path}
            </button>
          ))}
        </div>
      )}
    </li>
  );
}

function Sent({ wait }: { wait: Wait }): JSX.Element {
  const progress = wait.progress.value;
  return (
    <>
      <progress aria-label={wait.name.value} {...(progress === null ? {} : { value: progress })} max={1} />
      <Waiting wait={wait} />
    </>
  );
}

function plural(count: number, noun: string): string {
  return `${count} ${noun}${count === 1 ? "" : "s"}`;
}
