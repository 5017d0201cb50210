/** Least squares of few unknowns. */

/** An equation: the weight of each unknown in it, by the index of that, and the value of their sum. */
export interface Equation {
  readonly terms: readonly (readonly [number, number])[];
  readonly value: number;
}

/** Share of the diagonal that holds unknowns which no equation tells. */
const RIDGE = 1e-10;

/**
 * The unknowns with which the sum of the squared errors of equations is least.
 *
 * @param weights of the squared errors, as many as equations.
 * @param count of the unknowns.
 */
export function solveSymmetric(equations: readonly Equation[], weights: readonly number[], count: number): number[] {
  const rows = Array.from({ length: count }, () => new Float64Array(count + 1));
  for (const [at, { terms, value }] of equations.entries()) {
    const weight = weights[at] ?? 0;
    for (const [i, a] of terms) {
      const row = rows[i];
      if (!row) continue;
      for (const [j, b] of terms) row[j] = (row[j] ?? 0) + weight * a * b;
      row[count] = (row[count] ?? 0) + weight * a * value;
    }
  }
  return eliminated(rows, count);
}

/** Solves symmetric positive equations by elimination, each unknown at its own scale. */
function eliminated(rows: readonly Float64Array[], count: number): number[] {
  const scales = rows.map((row, i) => 1 / Math.sqrt(Math.max(row[i] ?? 0, 1e-300)));
  const scale = (i: number): number => scales[i] ?? 1;
  for (const [i, row] of rows.entries()) {
    for (let j = 0; j < count; j += 1) row[j] = (row[j] ?? 0) * scale(i) * scale(j);
    row[i] = (row[i] ?? 0) + RIDGE;
    row[count] = (row[count] ?? 0) * scale(i);
  }
  for (const [i, pivot] of rows.entries()) {
    for (const row of rows.slice(i + 1)) {
      const factor = (row[i] ?? 0) / (pivot[i] ?? 1);
      if (factor === 0) continue;
      for (let j = i; j <= count; j += 1) row[j] = (row[j] ?? 0) - factor * (pivot[j] ?? 0);
    }
  }
  const found = new Array<number>(count).fill(0);
  for (let i = count - 1; i >= 0; i -= 1) {
    const row = rows[i];
    let rest = row?.[count] ?? 0;
    for (let j = i + 1; j < count; j += 1) rest -= (row?.[j] ?? 0) * (found[j] ?? 0);
    found[i] = rest / (row?.[i] ?? 1);
  }
  return found.map((value, i) => value * scale(i));
}
