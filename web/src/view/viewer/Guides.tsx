/** The frame of a delivery on the picture: what falls outside of it is dimmed. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { guideIn } from "../../model/photography";

export function Guides({ editor, session }: { editor: Editor; session: Session }): JSX.Element | null {
  const name = editor.remembered.guide.value;
  const shape = editor.libraries.value.shapes.find((one) => one.name === name);
  if (!shape) return null;
  const { left, top, width, height } = guideIn(session.aspect, shape.aspect);
  const part = (share: number): string => `${(100 * share).toFixed(3)}%`;
  const frame = { left: part(left), top: part(top), width: part(width), height: part(height) };
  return (
    <div class="guides" role="img" aria-label={`Framing guide ${name}`}>
      <div class="guide" style={frame}>
        <span>{name}</span>
      </div>
    </div>
  );
}

/** Circle of the light meter's spot, shown while the meter is open. */
export function MeterSpot({ editor, session }: { editor: Editor; session: Session }): JSX.Element | null {
  const meter = session.photography.meter.value;
  if (editor.remembered.panel.value !== "camera" || meter?.mode !== "spot" || !meter.place) return null;
  const [x, y] = meter.place;
  return <div class="meter-spot" style={{ left: `${100 * x}%`, top: `${100 * y}%` }} />;
}
