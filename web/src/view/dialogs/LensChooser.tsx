/** Which lens is on the camera: one of the library, the thin lens, or one of a lens file. */

import type { JSX } from "preact";
import { useRef, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { grouped, mountedLens, type LensSummary, type MountedLens } from "../../model/lens";
import type { Readout } from "../../model/shot";
import { Edits } from "../controls/Edits";

const THIN = "";
const OTHER = "*";

interface LensChooserProps {
  readonly editor: Editor;
  readonly session: Session;
  readonly readout: Readout;
}

export function LensChooser({ editor, session, readout }: LensChooserProps): JSX.Element {
  const lenses = editor.lenses.value;
  const mounted = mountedLens(readout, lenses);
  const file = useRef<HTMLInputElement>(null);
  return (
    <div class="lens-choice">
      <Edits session={session}>
        <select
          aria-label="Lens on the camera"
          value={valueOf(mounted)}
          onChange={(event) => {
            session.mounting.lens(lenses.find(({ name }) => name === event.currentTarget.value) ?? null);
          }}
        >
          {mounted.kind === "other" && <option value={OTHER}>{mounted.title}</option>}
          <option value={THIN}>Thin lens</option>
          {grouped(lenses).map(([label, members]) => (
            <optgroup key={label} label={label}>
              {members.map(({ name, title }) => (
                <option key={name} value={name}>
                  {title}
                </option>
              ))}
            </optgroup>
          ))}
        </select>
        <button
          type="button"
          class="button"
          title="Mount a lens from a file: pbrt .dat, Zemax .zmx, CODE V .seq, Optical Bench .txt or data sheet .lens"
          onClick={() => file.current?.click()}
        >
          File…
        </button>
        <input
          ref={file}
          type="file"
          hidden
          aria-label="Lens file"
          accept=".dat,.zmx,.seq,.txt,.lens"
          onChange={({ currentTarget }) => {
            const chosen = currentTarget.files?.[0];
            if (chosen) session.mounting.lensFile(chosen);
            currentTarget.value = "";
          }}
        />
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

function valueOf(mounted: MountedLens): string {
  if (mounted.kind === "library") return mounted.lens.name;
  return mounted.kind === "thin" ? THIN : OTHER;
}

function descriptionOf(mounted: MountedLens): string {
  if (mounted.kind === "library") return mounted.lens.description;
  return mounted.kind === "thin"
    ? "No errors: the ideal lens of the numbers below."
    : "Of the shot, or of a lens file.";
}
