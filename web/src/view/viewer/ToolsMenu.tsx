/** The tools on the picture: how it is enlarged, what is drawn over it, and what it is compared with. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { EXPOSURE_LOOKS, ZEBRA_STOPS, type ExposureLook, type ZebraStops } from "../../model/exposure_map";
import { Choice, Options } from "../controls/Choice";
import { Menu } from "../controls/Menu";
import { Radios } from "../controls/Radios";
import { fullScreenRefusal, toggleFullScreen } from "../full_screen";
import { Icon } from "../icons";
import { AddNote } from "../notes/AddNote";
import { CompareChoices } from "./CompareChoices";
import { BurnInChoices, GuideChoices } from "./GuideChoices";

export function ToolsMenu({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  return (
    <Menu name="tools" label="Tools on the picture" title="Tools on the picture" head={<Icon name="loupe" />}>
      {(close) => (
        <div class="tool-choices">
          <h2>Enlarge</h2>
          <Enlarge session={session} close={close} />
          <h2>Exposure</h2>
          <ExposureChoices editor={editor} />
          <ScopesSwitch editor={editor} />
          <h2>Notes</h2>
          <NoteTools session={session} close={close} />
          <h2>Guides</h2>
          <GuideChoices editor={editor} />
          <h2>Burn-ins</h2>
          <BurnInChoices editor={editor} />
          <h2>Compare</h2>
          <CompareChoices editor={editor} session={session} />
        </div>
      )}
    </Menu>
  );
}

function NoteTools({ session, close }: { session: Session; close: () => void }): JSX.Element {
  const { frameNotes } = session;
  return (
    <div class="tool-buttons">
      <button
        type="button"
        class="button"
        title="Notes of this shot (Alt Shift N)"
        onClick={() => {
          close();
          frameNotes.isShown.value = true;
        }}
      >
        List ({frameNotes.list.value.length})
      </button>
      <AddNote session={session} label="Add" onBegin={close} />
    </div>
  );
}

const EXPOSURE_NAMES: Readonly<Record<ExposureLook, string>> = {
  none: "Nothing",
  falseColour: "False colour",
  zebra: "Zebra",
};

function ExposureChoices({ editor: { remembered } }: { editor: Editor }): JSX.Element {
  const { exposureLook, zebraStops } = remembered;
  return (
    <>
      <Radios
        label="Exposure as"
        values={EXPOSURE_LOOKS}
        value={exposureLook.value}
        names={EXPOSURE_NAMES}
        onChoose={(name) => (exposureLook.value = name)}
      />
      {exposureLook.value === "zebra" && (
        <Choice
          label="Stripes from"
          value={zebraStops.value}
          hint="Stops above a grey of 18 %, on the film and before film and grade"
          onChoose={(stops) => (zebraStops.value = stops as ZebraStops)}
        >
          <Options values={ZEBRA_STOPS} />
        </Choice>
      )}
    </>
  );
}

function ScopesSwitch({ editor: { remembered } }: { editor: Editor }): JSX.Element {
  return (
    <label class="check" title="Histogram, waveform, parade and vectorscope of the picture, below it (Shift H)">
      <input
        type="checkbox"
        checked={remembered.scopes.value === "on"}
        onChange={(event) => (remembered.scopes.value = event.currentTarget.checked ? "on" : "off")}
      />
      Scopes: histogram, waveform, vectorscope
    </label>
  );
}

function Enlarge({ session: { zoom }, close }: { session: Session; close: () => void }): JSX.Element {
  const scale = zoom.scale.value;
  return (
    <>
      <div class="tool-buttons">
        <button
          type="button"
          class="button"
          onClick={() => {
            zoom.toggle(null);
          }}
        >
          {scale === null ? "Pixels 1:1" : `Whole picture (${Math.round(100 * scale)} % now)`}
        </button>
        <button
          type="button"
          class="button"
          disabled={fullScreenRefusal() !== null}
          title={fullScreenRefusal() ?? "Picture on the full screen (Alt F)"}
          onClick={() => {
            close();
            void toggleFullScreen();
          }}
        >
          Full screen
        </button>
      </div>
      <label class="check">
        <input
          type="checkbox"
          checked={zoom.loupe.value}
          onChange={(event) => (zoom.loupe.value = event.currentTarget.checked)}
        />
        Loupe at the pointer
      </label>
    </>
  );
}
