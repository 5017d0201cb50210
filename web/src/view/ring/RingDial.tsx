/** The ring itself: dragged, or turned by the wheel and by keys, while its scale goes past the line. */

import type { JSX, RefObject } from "preact";
import { useEffect, useMemo, useRef } from "preact/hooks";
import type { RingDesk } from "../../editor/ring_desk";
import { formatDistance, formatMark, type LengthUnit } from "../../model/distance";
import { engravings, saidFrom, turnAt, type Origin, type Ring } from "../../model/ring";
import { followPointer, useSize } from "../hooks";
import { dialOf, type Dial } from "./dial";

interface RingDialProps {
  readonly desk: RingDesk;
  readonly ring: Ring;
  readonly unit: LengthUnit;
}

/** Turns of an arrow key: plain, with Shift and with Alt; and of a page key. */
const [STEP, COARSE, FINE, PAGE] = [0.002, 0.02, 0.0005, 0.05];
/** Turn for a px of a wheel: plain, with Shift and with Alt. */
const [WHEEL, COARSE_WHEEL, FINE_WHEEL] = [5e-5, 2.5e-4, 1e-5];

const ORIGIN_NAMES: Readonly<Record<Origin, string>> = {
  film: "from the film",
  pupil: "from the entrance pupil",
};

export function RingDial({ desk, ring, unit }: RingDialProps): JSX.Element {
  const box = useRef<HTMLDivElement>(null);
  const { width } = useSize(box);
  const turn = desk.ring.turn.value;
  const origin = desk.choices.origin.value;
  const dial = dialOf(Math.max(width, 1), turn);
  const said = formatDistance(saidFrom(origin, ring, desk.ring.distanceM.value), unit);
  useWheel(box, desk);
  return (
    <div
      ref={box}
      class={`dial ${desk.ring.isByHand.value ? "by-hand" : ""}`}
      role="slider"
      tabIndex={0}
      aria-label="Focus ring"
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={Number((100 * turn).toFixed(2))}
      aria-valuetext={`${said} ${ORIGIN_NAMES[origin]}`}
      onPointerDown={(down) => {
        if (down.button !== 0) return;
        drag(desk, dial, down);
      }}
      onKeyDown={(event) => {
        if (turnByKey(desk, event)) event.preventDefault();
      }}
    >
      {width > 0 && <Face desk={desk} ring={ring} dial={dial} unit={unit} />}
      <p class="dial-reading" aria-hidden="true">
        <b class="numbers">{said}</b> <span class="muted">{ORIGIN_NAMES[origin]}</span>
      </p>
    </div>
  );
}

/** The scale goes with the pointer. */
function drag({ ring }: RingDesk, dial: Dial, down: PointerEvent): void {
  let last = down.clientX;
  followPointer(
    down,
    (event) => {
      ring.turnBy(dial.turnOf(last - event.clientX));
      last = event.clientX;
    },
    () => undefined,
  );
}

function turnByKey({ ring }: RingDesk, { key, shiftKey, altKey, ctrlKey, metaKey }: KeyboardEvent): boolean {
  if (ctrlKey || metaKey) return false;
  if (key === "Home" || key === "End") {
    ring.easeTo(key === "Home" ? 0 : 1);
    return true;
  }
  if (key === "Escape" && ring.isByHand.peek()) {
    ring.letGo();
    return true;
  }
  const step = shiftKey ? COARSE : altKey ? FINE : STEP;
  const by: Readonly<Record<string, number>> = {
    ArrowRight: step,
    ArrowUp: step,
    ArrowLeft: -step,
    ArrowDown: -step,
    PageUp: PAGE,
    PageDown: -PAGE,
  };
  if (by[key] === undefined) return false;
  ring.easeBy(by[key]);
  return true;
}

/** Turns by the wheel: away from the hand goes farther. */
function useWheel(box: RefObject<HTMLDivElement | null>, { ring }: RingDesk): void {
  useEffect(() => {
    const element = box.current;
    const turned = (event: WheelEvent): void => {
      if (event.ctrlKey) return; // it enlarges the page
      event.preventDefault();
      const { deltaX, deltaY, deltaMode, shiftKey, altKey } = event;
      const px = (deltaY || deltaX) * (deltaMode === WheelEvent.DOM_DELTA_LINE ? 33 : 1);
      ring.easeBy(-px * (shiftKey ? COARSE_WHEEL : altKey ? FINE_WHEEL : WHEEL));
    };
    element?.addEventListener("wheel", turned, { passive: false });
    return () => {
      element?.removeEventListener("wheel", turned);
    };
  }, [box, ring]);
}

/** Places of what is on the ring, px outwards from the circle between the marking disk and the scale. */
const [DISK, SCALE, NUMBERS, KNURL] = [11, -17, -22, -46];

function Face({ desk, ring, dial, unit }: RingDialProps & { readonly dial: Dial }): JSX.Element {
  const origin = desk.choices.origin.value;
  const scale = useMemo(() => engravings(ring, unit, origin), [ring, unit, origin]);
  const first = dial.at(0, 0);
  const middle = dial.width / 2;
  return (
    <svg width={dial.width} height={dial.height} aria-hidden="true">
      <path class="disk" d={dial.arc(DISK)} />
      <path class="scale" d={dial.arc(SCALE)} />
      <path
        class="knurl"
        d={dial.arc(KNURL)}
        // The pattern goes with the ring.
        stroke-dashoffset={((-(first.angle * Math.PI) / 180) * (dial.radius + KNURL)).toFixed(1)}
      />
      {scale
        .filter(({ turn }) => dial.shows(turn))
        .map(({ turn, distanceM, isNamed }) => {
          const [from, to] = [dial.at(turn, 0), dial.at(turn, isNamed ? -10 : -6)];
          const text = dial.at(turn, NUMBERS);
          return (
            <g key={distanceM} class="engraving">
              <line x1={from.x} y1={from.y} x2={to.x} y2={to.y} />
              {isNamed && (
                <text
                  transform={`translate(${text.x.toFixed(1)} ${text.y.toFixed(1)}) rotate(${text.angle.toFixed(2)})`}
                >
                  {formatMark(distanceM, unit)}
                </text>
              )}
            </g>
          );
        })}
      <Marks desk={desk} ring={ring} dial={dial} />
      <path class="witness" d={`M${middle - 5} 1h10l-5 6zM${middle} 31V48`} />
    </svg>
  );
}

/** The numbered marks on the disk at the ring's edge. */
function Marks({ desk, ring, dial }: { desk: RingDesk; ring: Ring; dial: Dial }): JSX.Element {
  return (
    <>
      {desk.notes.value.marks.map((distanceM, at) => {
        const turn = distanceM === null ? null : turnAt(ring, distanceM);
        if (turn === null || !dial.shows(turn)) return null;
        const [line, end, text] = [dial.at(turn, 0), dial.at(turn, 6), dial.at(turn, 9)];
        return (
          <g key={at} class="ring-mark" data-mark={at + 1}>
            <line x1={line.x} y1={line.y} x2={end.x} y2={end.y} />
            <text transform={`translate(${text.x.toFixed(1)} ${text.y.toFixed(1)}) rotate(${text.angle.toFixed(2)})`}>
              {at + 1}
            </text>
          </g>
        );
      })}
    </>
  );
}
