/** Choice of what a focus point follows: its place on the surface, or the bounds of a part such as a whole character. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { holderOf, partsOf, surfaceOf } from "../../model/parts";
import { primName, type FocusPoint } from "../../model/shot";

export function FollowedPart({ session, point }: { session: Session; point: FocusPoint }): JSX.Element {
  const surface = surfaceOf(point);
  return (
    <label class="choice" title={hintOf(point)}>
      <span>Follows</span>
      <select
        value={point.part}
        onChange={({ currentTarget }) => {
          void session.pointEdits.follow(point, currentTarget.value).then((isMade) => {
            if (!isMade) currentTarget.value = point.part;
          });
        }}
      >
        {surface !== "" && <option value="">This place on {primName(surface)}</option>}
        {partsOf(point, session.shot.cameraPaths).map((path) => (
          <option key={path} value={path} title={path}>
            {path === surface ? `All of ${primName(path)}` : primName(path)}
          </option>
        ))}
      </select>
    </label>
  );
}

function hintOf(point: FocusPoint): string {
  const holder = holderOf(point);
  return point.part === ""
    ? `Stays on this place of ${holder}. Choose a part to follow its bounds, so that the point stays when the mesh changes`
    : `Follows the bounds of ${holder}, so that the point stays with it when its mesh changes`;
}
