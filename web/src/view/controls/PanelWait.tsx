/** What a panel waits for before it has anything to show. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { Waiting } from "./Waiting";

export function PanelWait({ session, what }: { session: Session; what: "lens" | "camera" }): JSX.Element {
  const wait = session.waits.of(what);
  return <div class="muted pad-all">{wait ? <Waiting wait={wait} /> : `The ${what} could not be read.`}</div>;
}
