/** Fields of a render that is typed, each with what is wrong with it. */

import type { ComponentChildren, JSX } from "preact";
import { useEffect, useId, useState } from "preact/hooks";
import type { RenderForm } from "../../editor/render_form";
import type { DraftField, TypedField } from "../../model/render_draft";

/** What a control says of its faults. */
interface Said {
  readonly "aria-invalid": boolean;
  readonly "aria-describedby": string | undefined;
}

export function faultsAt(form: RenderForm, field: DraftField): readonly string[] {
  return form.faults.value.filter((fault) => fault.field === field).map(({ message }) => message);
}

interface RowProps {
  readonly form: RenderForm;
  readonly field: DraftField;
  readonly label: string;
  readonly children: (said: Said) => ComponentChildren;
}

/** A field with what is wrong with it. */
export function Row({ form, field, label, children }: RowProps): JSX.Element {
  const id = useId();
  const faults = faultsAt(form, field);
  const isWrong = faults.length > 0;
  return (
    <label class={`render-field of-${field}`}>
      <span>{label}</span>
      {children({ "aria-invalid": isWrong, "aria-describedby": isWrong ? id : undefined })}
      {isWrong && (
        <span id={id} class="render-fault" role="alert">
          {faults.join(" ")}
        </span>
      )}
    </label>
  );
}

interface TextProps extends Omit<RowProps, "children"> {
  readonly field: TypedField;
  readonly hint: string;
  readonly placeholder?: string;
}

export function Text({ hint, placeholder, ...row }: TextProps): JSX.Element {
  const { form, field } = row;
  const isNumber = field === "width" || field === "rays" || field === "priority";
  return (
    <Row {...row}>
      {(said) => (
        <input
          {...said}
          type="text"
          class="text-field"
          data-field={field}
          title={hint}
          inputMode={isNumber ? "numeric" : "text"}
          autocomplete="off"
          spellcheck={false}
          maxLength={field === "name" ? 200 : 4000}
          placeholder={placeholder}
          value={form.draft.value[field]}
          onInput={({ currentTarget }) => {
            form.type({ [field]: currentTarget.value });
          }}
        />
      )}
    </Row>
  );
}

interface FoldedFieldProps {
  readonly form: RenderForm;
  readonly field: DraftField;
  readonly label: string;
  /** What is chosen: it is read without opening them. */
  readonly summary: string;
  readonly children: ComponentChildren;
}

/** Choices that are folded away, and open where something is wrong with them. */
export function FoldedField({ form, field, label, summary, children }: FoldedFieldProps): JSX.Element {
  const [isOpen, setOpen] = useState(false);
  const id = useId();
  const isWrong = faultsAt(form, field).length > 0;
  const isShown = isOpen || isWrong;
  useEffect(() => {
    if (isWrong) setOpen(true); // they stay open while it is put right
  }, [isWrong]);
  return (
    <div class={`render-choices of-${field}`}>
      <button
        type="button"
        class="fold"
        aria-expanded={isShown}
        aria-controls={isShown ? id : undefined}
        onClick={() => {
          setOpen(isWrong || !isOpen);
        }}
      >
        {label} <span class="muted">{summary}</span>
      </button>
      {isShown && <div id={id}>{children}</div>}
    </div>
  );
}

interface CheckProps {
  readonly name: string;
  /** Beside the name. */
  readonly help: string;
  readonly isChecked: boolean;
  readonly isWrong?: boolean;
  readonly onCheck: (isChecked: boolean) => void;
}

/** One of several choices. */
export function Check({ name, help, isChecked, isWrong = false, onCheck }: CheckProps): JSX.Element {
  const id = useId();
  return (
    <label class="check">
      <input
        type="checkbox"
        class="switch"
        aria-labelledby={`${id}-name`}
        aria-describedby={`${id}-help`}
        aria-invalid={isWrong}
        checked={isChecked}
        onChange={({ currentTarget }) => {
          onCheck(currentTarget.checked);
        }}
      />
      <span>
        <b id={`${id}-name`}>{name}</b>{" "}
        <span id={`${id}-help`} class="muted">
          {help}
        </span>
      </span>
    </label>
  );
}
