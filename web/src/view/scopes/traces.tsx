/** Scopes that are densities: brighter where more pixels are. */

import type { JSX } from "preact";
import { useLayoutEffect, useMemo, useRef } from "preact/hooks";
import { painted, SKIN_DEG, TARGETS, vectorscopeOf, waveformOf, type Channel, type Density } from "../../model/scopes";
import type { Counted } from "./counted";
import { Scale } from "./Scale";

const COLOURS: Readonly<Record<Channel, readonly [number, number, number]>> = {
  red: [255, 90, 80],
  green: [90, 255, 110],
  blue: [100, 150, 255],
  luma: [255, 255, 255],
};

export function Waveform(counted: Counted): JSX.Element {
  return <Waves {...counted} name="Waveform of luma" channels={["luma"]} />;
}

export function Parade(counted: Counted): JSX.Element {
  return <Waves {...counted} name="Waveforms of red, green and blue" channels={["red", "green", "blue"]} />;
}

interface WavesProps extends Counted {
  readonly name: string;
  readonly channels: readonly Channel[];
}

function Waves({ planes, width, name, channels }: WavesProps): JSX.Element {
  return (
    <figure class="scope up">
      <Scale />
      <div class="scope-plot" role="img" aria-label={name}>
        {channels.map((channel) => (
          <Wave key={channel} plane={planes[channel]} width={width} channel={channel} />
        ))}
      </div>
    </figure>
  );
}

function Wave({ plane, width, channel }: { plane: Uint8Array; width: number; channel: Channel }): JSX.Element {
  const density = useMemo(() => waveformOf(plane, width), [plane, width]);
  return <Trace density={density} channel={channel} />;
}

function Trace({ density, channel }: { density: Density; channel: Channel }): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  const { width, height } = density;
  useLayoutEffect(() => {
    const context = canvas.current?.getContext("2d", { alpha: false });
    context?.putImageData(new ImageData(painted(density, COLOURS[channel]), width, height), 0, 0);
  }, [density, channel, width, height]);
  return <canvas ref={canvas} width={width} height={height} data-channel={channel} aria-hidden="true" />;
}

export function Vectorscope({ planes }: Counted): JSX.Element {
  const density = useMemo(() => vectorscopeOf(planes), [planes]);
  return (
    <figure class="scope vectorscope">
      <div
        class="scope-plot"
        role="img"
        aria-label="Vectorscope of Cb and Cr, with targets of 75 % and the line of skin"
      >
        <Trace density={density} channel="luma" />
        <Graticule />
      </div>
    </figure>
  );
}

/** Half the side of a target, in levels. */
const TARGET = 6;
/** How far the name of a target is out, in parts of its distance from the middle. */
const BEYOND = 1.22;
/** Middle of the level 0 in the drawing, whose y goes down. */
const [MIDDLE_X, MIDDLE_Y] = [128.5, 127.5];
const RADIUS = 127.5;

function Graticule(): JSX.Element {
  const skin = (SKIN_DEG * Math.PI) / 180;
  return (
    <>
      <svg viewBox="0 0 256 256" aria-hidden="true">
        <g transform={`translate(${MIDDLE_X} ${MIDDLE_Y}) scale(1 -1)`}>
          <circle r={RADIUS} />
          <path d={`M${-RADIUS} 0H${RADIUS}M0 ${-RADIUS}V${RADIUS}`} />
          <path class="skin" d={`M0 0L${RADIUS * Math.cos(skin)} ${RADIUS * Math.sin(skin)}`} />
          {TARGETS.map(({ name, chroma: [cb, cr] }) => (
            <rect
              key={name}
              data-target={name}
              x={cb - TARGET}
              y={cr - TARGET}
              width={2 * TARGET}
              height={2 * TARGET}
            />
          ))}
        </g>
      </svg>
      {TARGETS.map(({ name, chroma: [cb, cr] }) => (
        <span
          key={name}
          class="target"
          aria-hidden="true"
          style={{
            left: `${((MIDDLE_X + BEYOND * cb) / 256) * 100}%`,
            top: `${((MIDDLE_Y - BEYOND * cr) / 256) * 100}%`,
          }}
        >
          {name}
        </span>
      ))}
    </>
  );
}
