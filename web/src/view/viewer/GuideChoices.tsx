/** The choice of what is drawn and written over the picture: framing guides, safe areas, a mask, and burn-ins. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import { FACTS } from "../../model/burn_in";
import { MARKS, SAFE_WITHIN, type GuideMark, type SafeWithin } from "../../model/guides";
import { Radios } from "../controls/Radios";
import { Toggles } from "../controls/Toggles";
import { FACT_NAMES } from "../fact_names";

export const MARK_NAMES: Readonly<Record<GuideMark, string>> = {
  action: "Action 93 %",
  title: "Title 90 %",
  thirds: "Thirds",
  cross: "Centre",
};
const WITHIN_NAMES: Readonly<Record<SafeWithin, string>> = {
  picture: "Safe in picture",
  guide: "Safe in smallest guide",
};

export function GuideChoices({ editor: { remembered, libraries } }: { editor: Editor }): JSX.Element {
  const { guides, marks, safeWithin } = remembered;
  const shapes = libraries.value.shapes.map(({ name }) => name);
  const isSafe = marks.has("action") || marks.has("title");
  return (
    <>
      <Toggles label="Framing guides" values={shapes} chosen={guides} />
      <Toggles label="Marks" values={MARKS} names={MARK_NAMES} chosen={marks} />
      {isSafe && guides.names.length > 0 && (
        <Radios
          label="Safe areas of"
          values={SAFE_WITHIN}
          value={safeWithin.value}
          names={WITHIN_NAMES}
          onChoose={(name) => (safeWithin.value = name)}
        />
      )}
      {guides.names.length > 0 && <Mask mask={remembered.mask} />}
    </>
  );
}

function Mask({ mask }: { mask: Editor["remembered"]["mask"] }): JSX.Element {
  const text = `${mask.value} %`;
  return (
    <label class="mask-choice" title="How dark it is outside of the smallest guide (Shift Q)">
      <span>Mask</span>
      <input
        type="range"
        class="slider"
        aria-label="Mask outside of the smallest guide"
        aria-valuetext={text}
        min={0}
        max={100}
        step={5}
        value={mask.value}
        style={{ "--at": text.replace(" ", "") }}
        onInput={({ currentTarget }) => (mask.value = Number(currentTarget.value))}
      />
      <span class="numbers">{text}</span>
    </label>
  );
}

export function BurnInChoices({ editor: { remembered } }: { editor: Editor }): JSX.Element {
  const { burnIn, burnInShown } = remembered;
  return (
    <>
      <label class="check" title="Text in the corners of the picture, for its frame (Alt B)">
        <input
          type="checkbox"
          checked={burnInShown.value === "on"}
          onChange={(event) => (burnInShown.value = event.currentTarget.checked ? "on" : "off")}
        />
        Burn-ins on the picture
      </label>
      {burnInShown.value === "on" && <Toggles label="Burn-ins" values={FACTS} names={FACT_NAMES} chosen={burnIn} />}
    </>
  );
}
