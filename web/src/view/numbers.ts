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

/** A size of a file, such as "6.1 MB". */
export function formatBytes(bytes: number): string {
  const power = Math.min(Math.floor(Math.log10(Math.max(bytes, 1)) / 3), 3);
  const value = bytes / 1000 ** power;
  return `${value.toFixed(value < 10 && power > 0 ? 1 : 0)} ${["B", "kB", "MB", "GB"][power] ?? "B"}`;
}
