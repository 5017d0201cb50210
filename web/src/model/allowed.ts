/** Numbers that the service takes. */

import type { Allowed } from "./settings.gen";

export function isAllowed({ least, most, above }: Allowed, value: number): boolean {
  return value <= most && (above ? value > least : value >= least);
}
