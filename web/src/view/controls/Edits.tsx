/** Controls that change the shot: disabled, with the reason, for somebody who may not edit it. */

import type { ComponentChildren, JSX } from "preact";
import type { Session } from "../../editor/session";

interface EditsProps {
  readonly session: Session;
  readonly children: ComponentChildren;
}

export function Edits({ session, children }: EditsProps): JSX.Element {
  const reason = session.document.noEdits.value;
  return (
    <fieldset class="edits" role="presentation" disabled={reason !== null} title={reason ?? undefined}>
      {children}
    </fieldset>
  );
}
