/** How bright things are on the film, drawn over the picture: false colour by stops from grey, or stripes from so many on. */

import { effect } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { BANDS, falseColour, zebra } from "../../model/exposure_map";

export function ExposureOverlay({ editor, session }: { editor: Editor; session: Session }): JSX.Element | null {
  const isOn = editor.remembered.exposureLook.value !== "none";
  useLayoutEffect(() => {
    session.exposureMaps.isWanted.value = isOn;
  }, [session, isOn]);
  if (!isOn) return null;
  return (
    <>
      <Painted editor={editor} session={session} />
      <Legend editor={editor} session={session} />
    </>
  );
}

function Painted({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(
    () =>
      effect(() => {
        if (canvas.current) paint(canvas.current, editor, session);
      }),
    [editor, session],
  );
  return <canvas ref={canvas} class="exposure" aria-hidden="true" />;
}

function paint(canvas: HTMLCanvasElement, { remembered }: Editor, { exposureMaps, pictures }: Session): void {
  const [map, look] = [exposureMaps.present.value, remembered.exposureLook.value];
  const [from, shown] = [Number(remembered.zebraStops.value), pictures.displayed.value];
  const isColour = look === "falseColour";
  const { width, height } = (isColour ? map : shown?.quality) ?? { width: 1, height: 1 };
  [canvas.width, canvas.height] = [width, height];
  if (map) canvas.dataset.painted = look;
  else delete canvas.dataset.painted;
  const context = canvas.getContext("2d");
  if (!map || !context) return;
  const pixels = isColour ? falseColour(map) : zebra(map, from, width, height);
  context.putImageData(new ImageData(pixels, width, height), 0, 0);
}

/** What the colours and stripes say. */
function Legend({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const { exposureLook, zebraStops } = editor.remembered;
  if (session.exposureMaps.present.value === null)
    return <p class="focus-legend of-exposure">Exposure comes after the picture…</p>;
  return (
    <div class="focus-legend of-exposure" role="note">
      {exposureLook.value === "zebra" ? (
        <span>Stripes: {zebraStops.value} stops above grey and more</span>
      ) : (
        <>
          <span class="bands">
            {BANDS.map(({ stop, rgb }) => (
              <b key={stop} style={{ background: `rgb(${rgb.join(" ")})` }}>
                {stop > 0 ? `+${stop}` : `${stop}`.replace("-", "−")}
              </b>
            ))}
          </span>
          <span>stops from grey, on the film</span>
        </>
      )}
    </div>
  );
}
