/** The renders that have to be done before a new one is drawn. */

import type { JSX } from "preact";
import type { RenderForm } from "../../editor/render_form";
import type { Renders } from "../../editor/renders";
import { formatEnd } from "../../model/identity";
import { stateInWords, waitableOf, type Render } from "../../model/renders";
import { Check, faultsAt, FoldedField } from "./DraftFields";

interface NeedChoiceProps {
  readonly form: RenderForm;
  readonly renders: Renders;
}

export function NeedChoice({ form, renders }: NeedChoiceProps): JSX.Element {
  const { draft } = form;
  const chosen = draft.value.after;
  const all = renders.all.value ?? [];
  const offered = waitableOf(all, chosen);
  const faults = faultsAt(form, "after");
  return (
    <FoldedField
      form={form}
      field="after"
      label="Wait for"
      summary={chosen.map(({ name }) => name).join(", ") || "no other render"}
    >
      {offered.length === 0 && <p class="muted">There is no render that is not done yet.</p>}
      <div class="render-checks" role="group" aria-label="Renders that have to be done before">
        {offered.map((render) => (
          <Check
            key={render.id}
            name={render.name}
            help={factsOf(render, all)}
            isChecked={chosen.some(({ id }) => id === render.id)}
            isWrong={faults.length > 0 && chosen.some(({ id }) => id === render.id)}
            onCheck={(isChecked) => {
              const others = draft.peek().after.filter(({ id }) => id !== render.id);
              form.type({ after: isChecked ? [...others, render] : others });
            }}
          />
        ))}
      </div>
      {faults.length > 0 && (
        <p class="render-fault" role="alert">
          {faults.join(" ")}
        </p>
      )}
    </FoldedField>
  );
}

function factsOf(render: Render, all: readonly Render[]): string {
  if (!all.some(({ id }) => id === render.id)) return "not in the list any more";
  return `frames ${render.frames}, ${formatEnd(render.createdAt, new Date())}: ${stateInWords(render, all)}`;
}
