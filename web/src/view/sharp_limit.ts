/** What counts as sharp on the page. */

import type { Editor } from "../editor/editor";
import type { Session } from "../editor/session";
import { gateWidthMm } from "../model/focus_map";
import { sharpLimitMm } from "../model/sharpness";

/** Width of the picture on the film; null where nothing says it yet. */
export function gateOf({ pictures, photography }: Session): number | null {
  const map = pictures.displayed.value?.focusMap;
  return map ? gateWidthMm(map) : (photography.current.value?.film.gateMm[0] ?? null);
}

/** Largest circle of confusion that is sharp, as the person chose; null where no lens is read yet. */
export function limitOf({ remembered }: Editor, session: Session): number | null {
  const filmLimitMm = session.document.readout.value?.cocLimitMm;
  const gateMm = gateOf(session);
  if (filmLimitMm === undefined || (gateMm === null && remembered.limit.value !== "film")) return null;
  return sharpLimitMm(remembered.limit.value, filmLimitMm, gateMm ?? 0, Number(remembered.delivery.value));
}
