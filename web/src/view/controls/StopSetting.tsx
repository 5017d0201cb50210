/** One stop: the f-number and the T-stop that go with it, on one slider that stops at thirds. The one on the barrel comes first. */

import type { JSX } from "preact";
import { detents, numberOfT, parseStop, sayStop, stopsOf, type Marking } from "../../model/stops";
import { F_NUMBERS } from "../../model/scale";
import type { Typed } from "./Field";
import { Setting } from "./Setting";

type Inherited = "session" | "setting" | "keys" | "value" | "fresh" | "startDrag" | "disabled" | "hint";

interface StopSettingProps extends Pick<Parameters<typeof Setting>[0], Inherited> {
  /** What the stops on the barrel are. */
  readonly marking: Marking;
  /** Of the glass, 0 to 1. */
  readonly transmittance: number;
}

const NAMES: Readonly<Record<Marking, string>> = { f: "f-number", t: "T-stop" };
const MARKS = detents(F_NUMBERS.min, F_NUMBERS.max).map(({ stop, isFull }) => ({
  at: F_NUMBERS.toPosition(stop),
  text: isFull ? stop.toString() : null,
}));

export function StopSetting({ marking, transmittance, ...setting }: StopSettingProps): JSX.Element {
  const [first, second] = marking === "f" ? (["f", "t"] as const) : (["t", "f"] as const);
  return (
    <Setting
      {...setting}
      {...typedAs(first, marking, transmittance)}
      shown="Stop"
      scale={F_NUMBERS}
      also={typedAs(second, marking, transmittance)}
      marks={MARKS}
    />
  );
}

/** How the number on the barrel is shown and typed as an f-number, or as a T-stop. */
function typedAs(letter: Marking, marking: Marking, transmittance: number): Typed {
  return {
    label: NAMES[letter],
    example: letter === "f" ? "2.8" : "T 3",
    format: (number) => sayStop(number === 0 ? 0 : stopsOf(number, marking, transmittance)[letter], letter),
    parse: (text) => {
      const typed = parseStop(text);
      if (!typed) return null;
      return (typed.letter ?? letter) === "t" ? numberOfT(typed.stop, marking, transmittance) : typed.stop;
    },
  };
}
