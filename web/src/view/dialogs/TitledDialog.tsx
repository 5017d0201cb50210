/** A dialog with a title above its content and a button that closes it below. Its content is shown while it is open. */

import type { ComponentChildren, JSX } from "preact";
import { useModal } from "../hooks";

interface TitledDialogProps {
  /** Class of its own, and beginning of the title's id. */
  readonly name: string;
  readonly title: string;
  readonly isOpen: boolean;
  readonly close: () => void;
  readonly children: ComponentChildren;
}

export function TitledDialog({ name, title, isOpen, close, children }: TitledDialogProps): JSX.Element {
  const ref = useModal(isOpen);
  const id = `${name}-title`;
  return (
    <dialog ref={ref} class={`help ${name}`} aria-labelledby={id} onClose={close}>
      {isOpen && (
        <>
          <h2 id={id}>{title}</h2>
          {children}
          <div class="dialog-foot">
            <button type="button" class="button" onClick={close}>
              Close
            </button>
          </div>
        </>
      )}
    </dialog>
  );
}
