/** How a declared setting is shown and typed: its scale, its unit, and the word for 0. */

import { formatStops } from "../../model/photography";
import { scaleOf, type Scale } from "../../model/scale";
import { isAllowed } from "../../model/allowed";
import type { Declared, SliderRange } from "../../model/settings.gen";
import { parseQuantity, trim } from "../numbers";

/** All that a field needs beside its value. */
export interface Quantity {
  readonly label: string;
  readonly hint: string;
  readonly scale: Scale;
  readonly example: string;
  readonly format: (value: number) => string;
  readonly parse: (text: string) => number | null;
}

/** The field of a declared setting; `special` stands in for a part that is shown or typed in its own way. */
export function quantityOf({ label, hint, slider, allowed }: Declared, special: Partial<Quantity> = {}): Quantity {
  const scale = scaleOf(slider);
  const format = (value: number): string => (value === 0 && slider.zero ? slider.zero : formatIn(slider, value));
  const parse = (text: string): number | null => {
    const value = slider.zero && text.trim() === slider.zero ? 0 : parseIn(slider, text);
    return value !== null && value < 0 && slider.least >= 0 ? null : value;
  };
  const quantity = { label, hint, scale, example: format(scale.toValue(0.75)), format, parse, ...special };
  return {
    ...quantity,
    parse: (text) => {
      const value = quantity.parse(text);
      return value !== null && isAllowed(allowed, value) ? value : null;
    },
  };
}

const PLACES: Readonly<Record<string, number>> = { K: 0, "°": 1, "°/s": 0, mm: 3 };
const CLOSE = ["×", "°", ""];

/** A number with its unit, in so many decimals. */
export function formatIn({ unit }: SliderRange, value: number, places = PLACES[unit] ?? 2): string {
  if (unit === "stops") return `${formatStops(value)} stops`;
  if (unit === "%") return `${trim(100 * value, 1)} %`;
  return `${trim(value, places)}${CLOSE.includes(unit) ? "" : " "}${unit}`;
}

function parseIn({ unit }: SliderRange, text: string): number | null {
  if (unit === "stops") return parseQuantity(text.replace("±", ""), text.trim().endsWith("stop") ? "stop" : "stops");
  const value = parseQuantity(text, unit);
  return value !== null && unit === "%" ? value / 100 : value;
}
