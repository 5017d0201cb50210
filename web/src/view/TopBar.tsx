/** The bar on top: what is open, what can be undone, how it is shown, and what can be taken away. */

import { Fragment, type JSX } from "preact";
import type { Editor } from "../editor/editor";
import { FOLDABLE } from "../editor/layout";
import { SURROUNDS, type Surround } from "../editor/remembered";
import type { Session } from "../editor/session";
import { primName } from "../model/shot";
import { Account } from "./Account";
import { CreateCamera } from "./controls/CreateCamera";
import { Menu } from "./controls/Menu";
import { DOWNLOADS } from "./commands/shot";
import { PANEL_NAMES } from "./commands/view";
import { Waiting } from "./controls/Waiting";
import { save } from "./hooks";
import { Icon } from "./icons";
import { MenuBar } from "./menus/MenuBar";
import { SharpnessMenu } from "./viewer/SharpnessMenu";
import { ToolsMenu } from "./viewer/ToolsMenu";
import { Radios } from "./controls/Radios";

export function TopBar({ editor }: { editor: Editor }): JSX.Element {
  const session = editor.session.value;
  return (
    <header class="topbar">
      <h1 class="wordmark">
        <Icon name="mark" />
        Pullfocus
      </h1>
      <MenuBar editor={editor} />
      {session && <CameraChoice editor={editor} session={session} />}
      <div class="spacer" />
      <Panels editor={editor} />
      {session && <UndoButtons session={session} />}
      <Appearance editor={editor} />
      <RendersButton editor={editor} />
      {session && <Downloads editor={editor} session={session} />}
      <Account editor={editor} />
      <button
        type="button"
        class="button icon-only"
        aria-label="Keys and clicks"
        title="Keys and clicks (?)"
        onClick={() => (editor.helpOpen.value = true)}
      >
        ?
      </button>
    </header>
  );
}

function CameraChoice({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const { cameras } = session.shot;
  const opening = editor.opening.value;
  // Where it cannot be opened, the choice goes back.
  const chosen = (opening?.shot === session.shot.id ? opening.camera : null) ?? session.camera ?? "";
  return (
    <div class="crumbs">
      <span class="shot-name">{session.shot.name}</span>
      <span class="slash" aria-hidden="true">
        /
      </span>
      {cameras.length === 0 ? (
        <span class="muted">{session.camera === null ? "no camera" : "no usable camera"}</span>
      ) : (
        <select
          aria-label="Camera"
          title={chosen}
          value={chosen}
          onChange={(event) => void editor.lookThrough(event.currentTarget.value)}
        >
          {chosen === "" && (
            <option value="" disabled>
              framing camera
            </option>
          )}
          {cameras.map(({ path }) => (
            <option key={path} value={path} title={path}>
              {primName(path)}
            </option>
          ))}
        </select>
      )}
      {(session.camera === null || cameras.length === 0) && (
        <CreateCamera editor={editor} session={session} label="Create a camera" />
      )}
    </div>
  );
}

function UndoButtons({ session }: { session: Session }): JSX.Element {
  const [undo, redo] = [session.document.undoLabel.value, session.document.redoLabel.value];
  const refusal = session.document.noEdits.value;
  const undoLabel = undo === null ? "Nothing to undo" : `Undo: ${undo}`;
  const redoLabel = redo === null ? "Nothing to redo" : `Redo: ${redo}`;
  return (
    <div class="group" role="group" aria-label="Undo and redo">
      <button
        type="button"
        class="button icon-only"
        disabled={undo === null || refusal !== null}
        aria-label={undoLabel}
        title={refusal ?? `${undoLabel} (Ctrl Z)`}
        onClick={() => void session.document.undo()}
      >
        <Icon name="undo" />
      </button>
      <button
        type="button"
        class="button icon-only"
        disabled={redo === null || refusal !== null}
        aria-label={redoLabel}
        title={refusal ?? `${redoLabel} (Ctrl Shift Z)`}
        onClick={() => void session.document.redo()}
      >
        <Icon name="redo" />
      </button>
    </div>
  );
}

/** Shows and folds the panels around the picture. */
function Panels({ editor: { layout } }: { editor: Editor }): JSX.Element {
  return (
    <div class="group panels" role="group" aria-label="Panels">
      {FOLDABLE.map((panel, at) => (
        <button
          key={panel}
          type="button"
          class={`button icon-only of-${panel}`}
          aria-pressed={layout.isShown(panel)}
          aria-label={PANEL_NAMES[panel]}
          title={`${PANEL_NAMES[panel]} (Shift ${at + 7})`}
          onClick={() => {
            layout.toggle(panel);
          }}
        >
          <Icon name={panel} />
        </button>
      ))}
    </div>
  );
}

const SURROUND_NAMES: Readonly<Record<Surround, string>> = { grey: "18 % grey", dark: "Dark grey", black: "Black" };

function Appearance({ editor }: { editor: Editor }): JSX.Element {
  const { unit, surround, markers, topView } = editor.remembered;
  const [shown, isSeenFromAbove] = [markers.value === "on", topView.value === "on"];
  return (
    <>
      <button
        type="button"
        class="button icon-only"
        aria-pressed={shown}
        aria-label="Show focus points on the picture"
        title="Show focus points (M)"
        onClick={() => (markers.value = shown ? "off" : "on")}
      >
        <Icon name="points" />
      </button>
      <button
        type="button"
        class="button icon-only"
        aria-pressed={isSeenFromAbove}
        aria-label="Top view"
        title="The set from above (V)"
        onClick={() => (topView.value = isSeenFromAbove ? "off" : "on")}
      >
        <Icon name="plan" />
      </button>
      <SharpnessMenu editor={editor} />
      {editor.session.value && <ToolsMenu editor={editor} session={editor.session.value} />}
      <div class="group" role="radiogroup" aria-label="Surround of the picture">
        {SURROUNDS.map((name) => (
          <button
            key={name}
            type="button"
            class={`button icon-only swatch ${name}`}
            role="radio"
            aria-checked={surround.value === name}
            aria-label={SURROUND_NAMES[name]}
            title={`Surround: ${SURROUND_NAMES[name]}`}
            onClick={() => (surround.value = name)}
          />
        ))}
      </div>
      <Radios
        label="Unit of distances"
        values={["m", "ft"] as const}
        value={unit.value}
        names={{ m: "m", ft: "ft" }}
        titles={{ m: "Metres", ft: "Feet and inches" }}
        isLarge
        onChoose={(name) => (unit.value = name)}
      />
    </>
  );
}

function RendersButton({ editor }: { editor: Editor }): JSX.Element {
  return (
    <button
      type="button"
      class="button icon-only of-renders"
      aria-label="Renders"
      title="Renders (Alt R)"
      onClick={() => (editor.rendersView.value = "list")}
    >
      <Icon name="renders" />
    </button>
  );
}

function Downloads({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const making = editor.waits.of("download");
  if (making) return <Waiting wait={making} />;
  return (
    <Menu
      name="downloads"
      label="Download"
      kind="primary"
      head={
        <>
          <Icon name="download" />
          Download
        </>
      }
    >
      {(close) => (
        <>
          {DOWNLOADS.map(({ group, what, refusal, make }, at, all) => (
            <Fragment key={what}>
              {group !== all[at - 1]?.group && <p class="menu-heading">{group}</p>}
              <button
                type="button"
                disabled={refusal(session) !== null}
                title={refusal(session) ?? undefined}
                onClick={() => {
                  close();
                  void editor.export(what, (abort) => make(session, abort), save);
                }}
              >
                {what}
              </button>
            </Fragment>
          ))}
          <p class="menu-heading">Frames, movie, reports</p>
          <button
            type="button"
            disabled={session.pictures.refusal !== null}
            title={session.pictures.refusal ?? "They are drawn one after the other, while you go on"}
            onClick={() => {
              close();
              editor.rendersView.value = "new";
            }}
          >
            Deliver…
          </button>
        </>
      )}
    </Menu>
  );
}
