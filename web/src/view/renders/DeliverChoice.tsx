/** What a render makes: frames, and what comes of them; and the facts in the corners of its pictures. */

import type { JSX } from "preact";
import type { RenderForm } from "../../editor/render_form";
import { BURNT_FACTS, PRODUCT_CHOICES, PRODUCT_KINDS, type BurntFact, type Made } from "../../model/deliverables";
import { FILE_CHOICES, type FileChoice } from "../../model/frame_files";
import { FACT_NAMES } from "../fact_names";
import { Check, faultsAt, FoldedField } from "./DraftFields";

interface FormProps {
  readonly form: RenderForm;
}

export function DeliverChoice({ form }: FormProps): JSX.Element {
  const { formats, productFormats } = form.draft.value;
  const faults = [...faultsAt(form, "made"), ...faultsAt(form, "formats")];
  return (
    <fieldset class="render-choices deliver">
      <legend>What to make</legend>
      <Item form={form} made="frames" name="Frames" help="a file for each, or two">
        <Formats
          label="Files"
          names={Object.fromEntries(Object.entries(FILE_CHOICES).map(([choice, { name }]) => [choice, name]))}
          value={formats}
          onChoose={(choice) => {
            form.type({ formats: choice as FileChoice });
          }}
        />
      </Item>
      {PRODUCT_KINDS.map((kind) => {
        const { name, help, formats: names } = PRODUCT_CHOICES[kind];
        return (
          <Item key={kind} form={form} made={kind} name={name} help={help}>
            {Object.keys(names).length > 1 && (
              <Formats
                label={`Format of the ${name.toLowerCase()}`}
                names={names}
                value={productFormats[kind]}
                onChoose={(format) => {
                  form.type({ productFormats: { ...form.draft.peek().productFormats, [kind]: format } });
                }}
              />
            )}
          </Item>
        );
      })}
      {faults.length > 0 && (
        <p class="render-fault" role="alert">
          {faults.join(" ")}
        </p>
      )}
    </fieldset>
  );
}

interface ItemProps extends FormProps {
  readonly made: Made;
  readonly name: string;
  readonly help: string;
  /** Choices of a thing that is made. */
  readonly children: JSX.Element | false;
}

function Item({ form, made, name, help, children }: ItemProps): JSX.Element {
  const isMade = form.draft.value.made.includes(made);
  return (
    <div class="deliver-item">
      <Check
        name={name}
        help={help}
        isChecked={isMade}
        isWrong={faultsAt(form, "made").length > 0}
        onCheck={(isChecked) => {
          const others = form.draft.peek().made.filter((other) => other !== made);
          form.type({ made: isChecked ? [...others, made] : others });
        }}
      />
      {isMade && children}
    </div>
  );
}

interface FormatsProps {
  readonly label: string;
  readonly names: Readonly<Record<string, string>>;
  readonly value: string;
  readonly onChoose: (format: string) => void;
}

function Formats({ label, names, value, onChoose }: FormatsProps): JSX.Element {
  return (
    <select
      aria-label={label}
      value={value}
      onChange={({ currentTarget }) => {
        onChoose(currentTarget.value);
      }}
    >
      {Object.entries(names).map(([format, name]) => (
        <option key={format} value={format}>
          {name}
        </option>
      ))}
    </select>
  );
}

export function BurnInChoice({ form }: FormProps): JSX.Element {
  const { burnIn } = form.draft.value;
  const chosen = BURNT_FACTS.filter((fact) => burnIn.includes(fact));
  return (
    <FoldedField
      form={form}
      field="burnIn"
      label="Burn-ins"
      summary={chosen.map((fact) => nameOf(fact).toLowerCase()).join(", ") || "none"}
    >
      <div class="render-checks" role="group" aria-label="Facts in the corners of graded pictures">
        {BURNT_FACTS.map((fact) => (
          <Check
            key={fact}
            name={nameOf(fact)}
            help=""
            isChecked={burnIn.includes(fact)}
            onCheck={(isChecked) => {
              const others = form.draft.peek().burnIn.filter((other) => other !== fact);
              form.type({ burnIn: isChecked ? [...others, fact] : others });
            }}
          />
        ))}
      </div>
    </FoldedField>
  );
}

function nameOf(fact: BurntFact): string {
  return fact === "focusFt" ? "Focus distance in feet" : FACT_NAMES[fact];
}
