/** Which lens is on the camera: one of the library, the thin lens, or one of a lens file. */

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { describedLens, grouped, mountedLens, type LensSummary, type MountedLens } from "../../model/lens";
import type { Readout } from "../../model/shot";
import { Edits } from "../controls/Edits";
import { SearchedChoice, type Option } from "../controls/SearchedChoice";
import { mountLensFile } from "../file_choices";

/** Identity of no lens of the library. */
const THIN = "thin";
const THIN_TITLE = "Thin lens";

interface LensChooserProps {
  readonly editor: Editor;
  readonly session: Session;
  readonly readout: Readout;
}

export function LensChooser({ editor, session, readout }: LensChooserProps): JSX.Element {
  const lenses = editor.lenses.value;
  const mounted = mountedLens(readout, lenses);
  return (
    <div class="lens-choice">
      <Edits session={session}>
        <SearchedChoice
          label="Lens on the camera"
          shown={titleOf(mounted)}
          groups={[["", [{ id: THIN, name: THIN_TITLE }]], ...grouped(lenses).map(toOptions)]}
          onChoose={(id) => {
            session.mounting.lens(lenses.find(({ name }) => name === id) ?? null);
          }}
        />
        <button
          type="button"
          class="button"
          title="Mount a lens from a file: pbrt .dat, Zemax .zmx, CODE V .seq, Optical Bench .txt, .roa, .json or data sheet .lens (Alt L)"
          onClick={() => {
            mountLensFile(session);
          }}
        >
          File…
        </button>
      </Edits>
      <p class="muted">{descriptionOf(mounted)}</p>
      {mounted.kind === "library" && (
        <LensSection
          key={mounted.lens.section}
          lens={mounted.lens}
          onOpen={() => (editor.sheet.value = { title: mounted.lens.title, address: mounted.lens.sheet })}
        />
      )}
    </div>
  );
}

/** The lens cut along its axis; nothing where the picture does not come. */
function LensSection({ lens, onOpen }: { lens: LensSummary; onOpen: () => void }): JSX.Element | null {
  const [lost, setLost] = useState(false);
  if (lost) return null;
  return (
    <button type="button" class="lens-section" title={`All about ${lens.title}, on a sheet`} onClick={onOpen}>
      <img
        src={lens.section}
        alt={`${lens.title}, cut along its axis, with rays to the film on the right`}
        width={346}
        height={144}
        onError={() => {
          setLost(true);
        }}
      />
    </button>
  );
}

function toOptions([heading, lenses]: ReturnType<typeof grouped>[number]): readonly [string, readonly Option[]] {
  return [heading, lenses.map(({ name, title, keywords }) => ({ id: name, name: title, keywords }))];
}

function titleOf(mounted: MountedLens): string {
  if (mounted.kind === "library") return mounted.lens.title;
  return mounted.kind === "thin" ? THIN_TITLE : mounted.title;
}

function descriptionOf(mounted: MountedLens): string {
  if (mounted.kind === "library") return describedLens(mounted.lens);
  return mounted.kind === "thin"
    ? "No errors: the ideal lens of the numbers below."
    : "Of the shot, or of a lens file.";
}
