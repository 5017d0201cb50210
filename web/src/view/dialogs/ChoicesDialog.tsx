/** What the open shot leaves open, in a dialog: its variant sets and its payloads. */

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import {
  chooseVariant,
  showPayload,
  type ChoiceEdit,
  type Choices,
  type Payload,
  type VariantSet,
} from "../../model/choices";
import { complaintOf } from "../../net/errors";
import { TitledDialog } from "./TitledDialog";

const NONE = "none";

export function ChoicesDialog({ editor }: { editor: Editor }): JSX.Element {
  const session = editor.session.value;
  const close = (): void => {
    editor.choicesOpen.value = false;
  };
  const isOpen = editor.choicesOpen.value && session !== null;
  return (
    <TitledDialog name="choices" title="Variants and payloads" isOpen={isOpen} close={close}>
      {session && <Content editor={editor} session={session} />}
    </TitledDialog>
  );
}

function Content({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const { choices, refusal: lost, again } = useChoices(editor, session);
  const { document } = session;
  const refusal = document.noEdits.value;
  const complaint = editor.complaint.value;
  if (lost !== null) {
    return (
      <p role="alert">
        {lost}{" "}
        <button type="button" class="button small" onClick={again}>
          Try again
        </button>
      </p>
    );
  }
  if (!choices) {
    return (
      <p class="muted" role="status">
        Reading what the shot leaves open…
      </p>
    );
  }
  const edit = ({ label, change }: ChoiceEdit): void => void document.edit(label, [change]);
  const { variantSets, payloads } = choices;
  const isOff = refusal !== null;
  return (
    <div class="choices-lists" tabIndex={0} role="group" aria-label="Variant sets and payloads">
      {refusal && <p class="muted">{refusal}</p>}
      {complaint && (
        <p class="refusal" role="alert">
          {complaint.message} {complaint.advice}
        </p>
      )}
      {variantSets.length + payloads.length === 0 && <p class="muted">The shot has no variant sets and no payloads.</p>}
      {!choices.complete && <p class="muted">The shot has more of them than are listed.</p>}
      {variantSets.length > 0 && (
        <section>
          <h3>Variants</h3>
          <ul>
            {variantSets.map((set) => (
              <Variant key={`${set.prim}.${set.name}`} set={set} isOff={isOff} edit={edit} />
            ))}
          </ul>
        </section>
      )}
      {payloads.length > 0 && (
        <section>
          <h3>Payloads</h3>
          <ul>
            {payloads.map((payload) => (
              <Loaded key={payload.prim} payload={payload} isOff={isOff} edit={edit} />
            ))}
          </ul>
        </section>
      )}
    </div>
  );
}

interface Read {
  /** Those of the present revision, or the last ones that were read; null until they are there. */
  readonly choices: Choices | null;
  /** Why they could not be read; null where they could. */
  readonly refusal: string | null;
  readonly again: () => void;
}

function useChoices(editor: Editor, session: Session): Read {
  const [choices, setChoices] = useState<Choices | null>(null);
  const [refusal, setRefusal] = useState<string | null>(null);
  const [tries, setTries] = useState(0);
  const { service } = editor;
  const shot = session.shot.id;
  const revision = session.document.revision.value;
  useEffect(() => {
    const abort = new AbortController();
    service.choices(shot, abort.signal).then(
      (found) => {
        setChoices(found);
        setRefusal(null);
      },
      (error: unknown) => {
        if (!abort.signal.aborted) setRefusal(complaintOf(error).message);
      },
    );
    return () => {
      abort.abort();
    };
  }, [service, shot, revision, tries]);
  const again = (): void => {
    setRefusal(null);
    setTries(tries + 1);
  };
  return { choices, refusal, again };
}

interface RowProps {
  readonly isOff: boolean;
  readonly edit: (edit: ChoiceEdit) => void;
}

function Variant({ set, isOff, edit }: RowProps & { set: VariantSet }): JSX.Element {
  const ref = useRef<HTMLSelectElement>(null);
  const label = `${set.name} of ${set.prim}`;
  return (
    <li>
      <span class="prim" title={set.prim}>
        {set.prim}
      </span>
      <span class="muted">{set.name}</span>
      <select
        ref={ref}
        aria-label={label}
        value={set.selection}
        disabled={isOff}
        onChange={(event) => {
          edit(chooseVariant(set, event.currentTarget.value));
        }}
      >
        <option value="">{NONE}</option>
        {set.variants.map((variant) => (
          <option key={variant} value={variant}>
            {variant}
          </option>
        ))}
      </select>
      <Reset
        label={label}
        isShown={set.edited}
        isOff={isOff}
        reset={() => {
          ref.current?.focus(); // the button goes
          edit(chooseVariant(set, null));
        }}
      />
    </li>
  );
}

function Loaded({ payload, isOff, edit }: RowProps & { payload: Payload }): JSX.Element {
  const ref = useRef<HTMLInputElement>(null);
  return (
    <li>
      <label class="prim" title={payload.prim}>
        <input
          ref={ref}
          type="checkbox"
          checked={payload.shown}
          disabled={isOff}
          onChange={(event) => {
            edit(showPayload(payload, event.currentTarget.checked));
          }}
        />
        {payload.prim}
      </label>
      <Reset
        label={payload.prim}
        isShown={payload.edited}
        isOff={isOff}
        reset={() => {
          ref.current?.focus();
          edit(showPayload(payload, null));
        }}
      />
    </li>
  );
}

interface ResetProps {
  readonly label: string;
  readonly isShown: boolean;
  readonly isOff: boolean;
  readonly reset: () => void;
}

function Reset({ label, isShown, isOff, reset }: ResetProps): JSX.Element | null {
  if (!isShown) return null;
  return (
    <button
      type="button"
      class="button small"
      aria-label={`As in the shot: ${label}`}
      title="Take the edit back"
      disabled={isOff}
      onClick={reset}
    >
      As in the shot
    </button>
  );
}
