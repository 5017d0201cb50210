/** The choice of what the picture is compared with, and how. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import {
  COMPARISONS,
  GAINS,
  saidOtherwise,
  THIN,
  type Comparing,
  type Gain,
  type Otherwise,
} from "../../model/comparison";
import { grouped } from "../../model/lens";
import { primName } from "../../model/shot";
import { detents, formatStop } from "../../model/stops";
import { Choice } from "../controls/Choice";
import { Radios } from "../controls/Radios";
import { snapshotName } from "./present";

export const COMPARING_NAMES: Readonly<Record<Comparing, string>> = {
  off: "Off",
  other: "Other",
  wipe: "Wipe",
  difference: "Difference",
  flicker: "Flicker",
};
const GAIN_NAMES: Readonly<Record<Gain, string>> = { "1": "1 ×", "4": "4 ×", "16": "16 ×" };

/** Stops that are offered. */
const STOPS = detents(0.7, 32)
  .filter(({ isFull }) => isFull)
  .map(({ stop }) => stop);

export function CompareChoices({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const { comparison } = session;
  const { mode, gain, chosen, snapshot, snapshots, otherwise } = comparison;
  const kept = snapshot.value;
  return (
    <>
      <Radios
        label="Compare by"
        values={COMPARISONS}
        value={mode.value}
        names={COMPARING_NAMES}
        onChoose={(name) => (mode.value = name)}
      />
      <Choice
        label="With"
        value={chosen.value?.toString() ?? ""}
        onChoose={(id) => (chosen.value = id === "" ? null : Number(id))}
      >
        <option value="">another camera, lens or stop ({saidOtherwise(otherwise.value, editor.lenses.value)})</option>
        {snapshots.value.map(({ id, said }) => (
          <option key={id} value={id}>
            {said}
          </option>
        ))}
      </Choice>
      {chosen.value === null && <OtherwiseChoices editor={editor} session={session} />}
      {mode.value === "difference" && (
        <Radios
          label="Difference times"
          values={GAINS}
          value={gain.value}
          names={GAIN_NAMES}
          onChoose={(name) => (gain.value = name)}
        />
      )}
      <div class="tool-buttons">
        <button type="button" class="button" onClick={() => void comparison.take(snapshotName(editor, session))}>
          Take a snapshot
        </button>
        {kept && (
          <button
            type="button"
            class="button"
            onClick={() => {
              comparison.drop(kept);
            }}
          >
            Drop it
          </button>
        )}
      </div>
    </>
  );
}

function OtherwiseChoices({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const { otherwise } = session.comparison;
  const { camera, lens, fStop } = otherwise.value;
  const set = (change: Partial<Otherwise>): void => {
    otherwise.value = { ...otherwise.value, ...change };
  };
  return (
    <>
      <Choice
        label="Camera"
        value={camera ?? ""}
        onChoose={(path) => {
          set({ camera: path === "" ? null : path });
        }}
      >
        <option value="">the present one</option>
        {session.shot.cameras.map(({ path }) => (
          <option key={path} value={path}>
            {primName(path)}
          </option>
        ))}
      </Choice>
      <Choice
        label="Lens"
        value={lens === null ? "" : `lens ${lens}`}
        onChoose={(name) => {
          set({ lens: name === "" ? null : name.slice("lens ".length) });
        }}
      >
        <option value="">the one that is mounted</option>
        <option value={`lens ${THIN}`}>Thin lens</option>
        {grouped(editor.lenses.value).map(([kind, lenses]) => (
          <optgroup key={kind} label={kind}>
            {lenses.map(({ name, title }) => (
              <option key={name} value={`lens ${name}`}>
                {title}
              </option>
            ))}
          </optgroup>
        ))}
      </Choice>
      <Choice
        label="Stop"
        value={fStop?.toString() ?? ""}
        onChoose={(stop) => {
          set({ fStop: stop === "" ? null : Number(stop) });
        }}
      >
        <option value="">the present one</option>
        {STOPS.map((stop) => (
          <option key={stop} value={stop}>
            {formatStop(stop)}
          </option>
        ))}
      </Choice>
    </>
  );
}
