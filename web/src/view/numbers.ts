/** Numbers as the panels write and read them. */

/** At most so many decimals, and no trailing zeros. */
export function trim(value: number, places: number): string {
  return (Number(value.toFixed(places)) + 0).toString();
}

/** A number that a person typed, with its unit or without; `null` for what is none. */
export function parseQuantity(text: string, unit: string): number | null {
  const typed = text.trim().replace(",", ".").replace("−", "-");
  const bare = typed.toLowerCase().endsWith(unit.toLowerCase()) ? typed.slice(0, typed.length - unit.length) : typed;
  const value = Number(bare.trim() || NaN);
  return Number.isFinite(value) ? value : null;
}
