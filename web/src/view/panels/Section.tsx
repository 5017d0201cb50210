/** A part of the settings under a heading, which folds it. */

import { createContext, type ComponentChildren, type JSX } from "preact";
import { useContext } from "preact/hooks";
import type { NameSet } from "../../editor/name_set";

/** Which sections are folded. */
export const FoldedContext = createContext<NameSet | null>(null);

interface SectionProps {
  readonly name: string;
  readonly title: string;
  /** What stands beside the title. */
  readonly aside?: ComponentChildren;
  readonly children: ComponentChildren;
}

export function Section({ name, title, aside, children }: SectionProps): JSX.Element {
  const folded = useContext(FoldedContext);
  const isFolded = folded?.has(name) ?? false;
  return (
    <section class={name} aria-labelledby={`${name}-title`}>
      <div class="panel-head">
        <h2 id={`${name}-title`}>
          <button
            type="button"
            class="fold"
            aria-expanded={!isFolded}
            title={isFolded ? `Show ${title.toLowerCase()}` : `Fold ${title.toLowerCase()}`}
            onClick={() => folded?.toggle(name)}
          >
            {title}
          </button>
        </h2>
        {!isFolded && aside}
      </div>
      {!isFolded && children}
    </section>
  );
}
