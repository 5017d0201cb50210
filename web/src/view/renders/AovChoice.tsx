/** The AOVs that the EXR files of a render hold beside the colour. */

import type { JSX } from "preact";
import type { RenderForm } from "../../editor/render_form";
import { aovsOf } from "../../model/aovs";
import { AOVS } from "../../model/settings.gen";
import { Check, FoldedField, Text } from "./DraftFields";

export function AovChoice({ form }: { form: RenderForm }): JSX.Element {
  const { draft } = form;
  const { aovs } = draft.value;
  return (
    <FoldedField form={form} field="primvars" label="AOVs" summary={aovsOf(draft.value).join(", ") || "none"}>
      <div class="render-checks" role="group" aria-label="AOVs in the EXR files">
        {AOVS.map(({ name, help }) => (
          <Check
            key={name}
            name={name}
            help={help}
            isChecked={aovs.includes(name)}
            onCheck={(isChecked) => {
              const others = draft.peek().aovs.filter((other) => other !== name);
              form.type({ aovs: isChecked ? [...others, name] : others });
            }}
          />
        ))}
      </div>
      <Text
        form={form}
        field="primvars"
        label="Primvars"
        hint="Names of primvars, such as st; a frame fails where nothing in it has one of them"
        placeholder="primvars:st"
      />
    </FoldedField>
  );
}
