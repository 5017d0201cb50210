/** What tells a focus point from the others: its colour, and the group that it is listed in. */

import type { JSX } from "preact";
import type { Session } from "../../editor/session";
import { groupNames } from "../../model/groups";
import { POINT_COLORS, type FocusPoint } from "../../model/shot";
import { useChosen } from "../controls/chosen";
import { TextSetting } from "../controls/TextSetting";

interface LabelProps {
  readonly session: Session;
  readonly point: FocusPoint;
}

export function PointColorChoice({ session, point }: LabelProps): JSX.Element {
  const [color, chosen] = useChosen(point.color, session.document.fresh.value);
  return (
    <div class="choice">
      <span>Colour</span>
      <div class="colors" role="radiogroup" aria-label={`Colour of ${point.name}`}>
        {POINT_COLORS.map((name) => (
          <button
            key={name}
            type="button"
            class="color"
            role="radio"
            data-color={name}
            aria-checked={color === name}
            aria-label={name === "none" ? "No colour" : name}
            title={name === "none" ? "No colour" : name}
            onClick={() => {
              if (name !== color) chosen.choose(name, session.pointEdits.setColor(point, name));
            }}
          />
        ))}
      </div>
    </div>
  );
}

export function PointGroupField({ session, point }: LabelProps): JSX.Element {
  const others = groupNames(session.document.points.value);
  return (
    <>
      <TextSetting
        label="Group"
        value={point.group}
        placeholder="none"
        title="Points of one group are listed and switched together"
        list="groups-of-points"
        onType={(typed) => session.pointEdits.setGroup(point, typed)}
      />
      <datalist id="groups-of-points">
        {others.map((name) => (
          <option key={name} value={name} />
        ))}
      </datalist>
    </>
  );
}
