/** Marks of a ground glass over the picture: frames of deliveries, safe areas, thirds and the centre; and the light meter's spot. */

import type { JSX } from "preact";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { guideFrames, SAFE, shareOf, smallest, WHOLE, type Box } from "../../model/guides";

export function Guides({ editor, session }: { editor: Editor; session: Session }): JSX.Element | null {
  const { guides, marks, safeWithin, mask } = editor.remembered;
  const frames = guideFrames(session.aspect, editor.libraries.value.shapes, guides.names);
  if (frames.length === 0 && marks.names.length === 0) return null;
  const inner = smallest(frames);
  const within = safeWithin.value === "guide" ? (inner?.box ?? WHOLE) : WHOLE;
  return (
    <div class="guides" role="img" aria-label={`Framing guides: ${[...guides.names, ...marks.names].join(", ")}`}>
      {inner && <div class="guide-mask" style={{ ...placeOf(inner.box), "--dark": Math.min(mask.value, 100) / 100 }} />}
      {marks.has("thirds") && <div class="guide-thirds" />}
      {marks.has("cross") && <div class="guide-cross" />}
      {(["action", "title"] as const)
        .filter((name) => marks.has(name))
        .map((name) => (
          <div key={name} class="guide-safe" data-name={name} style={placeOf(shareOf(within, SAFE[name]))}>
            <span>{name}</span>
          </div>
        ))}
      {frames.map(({ name, box }, at) => (
        <div key={name} class="guide" data-name={name} data-colour={at % COLOURS} style={placeOf(box)}>
          <span style={{ "--beside": at - (frames.length - 1) / 2 }}>{name}</span>
        </div>
      ))}
    </div>
  );
}

/** Number of colours that tell guides apart. */
const COLOURS = 5;

function placeOf({ left, top, width, height }: Box): Record<keyof Box, string> {
  const part = (share: number): string => `${(100 * share).toFixed(4)}%`;
  return { left: part(left), top: part(top), width: part(width), height: part(height) };
}

/** Circle of the light meter's spot, shown while the meter is open. */
export function MeterSpot({ editor, session }: { editor: Editor; session: Session }): JSX.Element | null {
  const meter = session.photography.meter.value;
  if (editor.remembered.panel.value !== "camera" || meter?.mode !== "spot" || !meter.place) return null;
  const [x, y] = meter.place;
  return <div class="meter-spot" style={{ left: `${100 * x}%`, top: `${100 * y}%` }} />;
}
