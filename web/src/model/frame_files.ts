/** Files of the frames of a render. */

import type { components } from "../net/schema";

export type FrameFormat = NonNullable<components["schemas"]["RenderRequest"]["formats"]>[number];

/** Files that can be chosen for each frame. */
export const FILE_CHOICES = {
  exr: { name: "Scene-linear (.exr)", formats: ["exr"] },
  png: { name: "Graded (.png)", formats: ["png"] },
  jpeg: { name: "Graded (.jpeg)", formats: ["jpeg"] },
  both: { name: "Scene-linear and graded (.exr, .png)", formats: ["exr", "png"] },
} as const satisfies Record<string, { name: string; formats: readonly FrameFormat[] }>;

export type FileChoice = keyof typeof FILE_CHOICES;

/** The format of a render that a browser shows; null where it has none. */
export function shownFormat(formats: readonly FrameFormat[]): FrameFormat | null {
  return formats.find((format) => format !== "exr") ?? null;
}
