/** A render that is typed, with what it would be. */

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import { RenderForm, type QuickFrames } from "../../editor/render_form";
import type { Renders } from "../../editor/renders";
import type { Session } from "../../editor/session";
import { holdsAovs, holdsFacts } from "../../model/render_draft";
import { planInWords, plural, settingsInWords, type Render, type RenderPlan } from "../../model/renders";
import { sentence } from "../../net/errors";
import { AovChoice } from "./AovChoice";
import { BurnInChoice, DeliverChoice } from "./DeliverChoice";
import { Text } from "./DraftFields";
import { NeedChoice } from "./NeedChoice";

interface NewRenderProps {
  readonly editor: Editor;
  readonly session: Session;
  readonly renders: Renders;
  readonly onSent: (render: Render) => void;
  readonly onCancel: () => void;
}

export function NewRender({ editor, session, renders, onSent, onCancel }: NewRenderProps): JSX.Element {
  const [form] = useState(() => {
    return new RenderForm(editor.service.renders, session, editor.remembered.delivery.peek(), editor.remembered);
  });
  const fields = useRef<HTMLFormElement>(null);
  useEffect(() => {
    fields.current?.querySelector<HTMLElement>("[data-field=frames]")?.focus();
    return () => {
      form.close();
    };
  }, [form]);
  const send = async (): Promise<void> => {
    const render = await form.send();
    if (render) onSent(render);
    else fields.current?.querySelector<HTMLElement>("[aria-invalid=true]")?.focus();
  };
  return (
    <form
      ref={fields}
      class="new-render"
      aria-label={`Render ${form.shotName}`}
      noValidate
      onSubmit={(event) => {
        event.preventDefault();
        void send();
      }}
    >
      <Text
        form={form}
        field="frames"
        label="Frames"
        hint="Such as 1-96, 1-96:2 or 1-10,15; empty for the whole shot"
      />
      <FrameChoice form={form} />
      <DeliverChoice form={form} />
      <Text
        form={form}
        field="width"
        label="Width, px"
        hint="Width of the pictures; their height follows from the film gate"
      />
      <Text form={form} field="rays" label="Rays" hint="Lens rays for each pixel: more of them leave less noise" />
      <Text form={form} field="priority" label="Priority" hint="0 to 100: renders of a higher one come first" />
      <Text form={form} field="name" label="Name" hint="For people and files" placeholder={form.shotName} />
      {holdsAovs(form.draft.value) && <AovChoice form={form} />}
      {holdsFacts(form.draft.value) && <BurnInChoice form={form} />}
      <NeedChoice form={form} renders={renders} />
      <Foot form={form} onCancel={onCancel} />
    </form>
  );
}

const QUICK_FRAMES: Readonly<Record<QuickFrames, string>> = {
  this: "This frame",
  range: "Played range",
  whole: "Whole shot",
};

/** The frames that are meant mostly, each by one press. */
function FrameChoice({ form }: { form: RenderForm }): JSX.Element {
  return (
    <div class="quick-frames" role="group" aria-label="Choose frames">
      {Object.entries(QUICK_FRAMES).map(([quick, name]) => {
        const frames = form.framesOf(quick as QuickFrames);
        return (
          <button
            key={quick}
            type="button"
            class="button small"
            aria-pressed={form.draft.value.frames.trim() === frames}
            title={`Frames ${frames}`}
            onClick={() => {
              form.type({ frames });
            }}
          >
            {name}
          </button>
        );
      })}
    </div>
  );
}

function Foot({ form, onCancel }: { form: RenderForm; onCancel: () => void }): JSX.Element {
  const plan = form.plan.value;
  const isSending = form.isSending.value;
  const refusals = form.faults.value.filter(({ field }) => field === null).map(({ message }) => message);
  return (
    <div class="render-foot">
      <p role="status" class="render-plan">
        {form.isTrying.value && <span class="muted">Checking… </span>}
        {plan && !form.isTrying.value && (
          <>
            {planInWords(plan)}
            <span class="muted"> {settingsInWords(plan)}</span>
          </>
        )}
      </p>
      {refusals.length > 0 && (
        <p class="render-fault" role="alert">
          {refusals.join(" ")}
        </p>
      )}
      {plan?.findings && plan.findings.length > 0 && <Findings findings={plan.findings} />}
      <button type="button" class="button" onClick={onCancel}>
        Cancel
      </button>
      <button type="submit" class="button primary" aria-disabled={isSending}>
        {isSending ? "Sending…" : "Send"}
      </button>
    </div>
  );
}

/** Findings that are listed. */
const MOST_FINDINGS = 3;

/** What is not drawn quite as the shot asks for. */
function Findings({ findings }: Required<Pick<RenderPlan, "findings">>): JSX.Element {
  const others = findings.length - MOST_FINDINGS;
  return (
    <ul class="render-findings muted" aria-label="Not drawn quite as asked for">
      {findings.slice(0, MOST_FINDINGS).map(({ message }, at) => (
        <li key={at}>{sentence(message)}</li>
      ))}
      {others > 0 && <li>{`And ${plural(others, "other finding")}.`}</li>}
    </ul>
  );
}
