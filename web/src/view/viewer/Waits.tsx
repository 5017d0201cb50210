/** The waits that have no place of their own on the page, over the foot of the picture. */

import type { JSX } from "preact";
import type { WaitKind } from "../../editor/waits";
import type { Editor } from "../../editor/editor";
import { Waiting } from "../controls/Waiting";

const KINDS: readonly WaitKind[] = ["opening", "edit", "pick"];

export function Waits({ editor }: { editor: Editor }): JSX.Element | null {
  const waits = KINDS.map((kind) => editor.waits.of(kind)).filter((wait) => wait !== null);
  if (waits.length === 0) return null;
  return (
    <div class="waits">
      {waits.map((wait) => (
        <Waiting key={wait.kind} wait={wait} />
      ))}
    </div>
  );
}
