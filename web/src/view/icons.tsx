/** The few signs of the page, drawn on a 16 × 16 grid. */

import type { JSX } from "preact";

const PATHS = {
  play: "M4.5 2.5v11l9-5.5z",
  pause: "M4 3h3v10H4zM9 3h3v10H9z",
  first: "M3 3h1.6v10H3zM13 3v10L5.5 8z",
  last: "M11.4 3H13v10h-1.6zM3 3v10l7.5-5z",
  back: "M11 3v10L3.5 8z",
  on: "M5 3v10l7.5-5z",
} as const;

const STROKES = {
  mark: "M1.5 5V1.5H5M11 1.5h3.5V5M14.5 11v3.5H11M5 14.5H1.5V11M10.6 8a2.6 2.6 0 1 1-5.2 0a2.6 2.6 0 1 1 5.2 0",
  plus: "M8 3v10M3 8h10",
  shots: "M2 3h12v10H2zM6 3v10",
  settings: "M2 3h12v10H2zM10 3v10",
  curve: "M2 3h12v10H2zM2 9h12",
  plan: "M8 14L2.5 2.5M8 14L13.5 2.5M4.4 6.5h7.2M8 2.5v1.5",
  menu: "M2.5 4.5h11M2.5 8h11M2.5 11.5h11",
  close: "M4 4l8 8M12 4l-8 8",
  undo: "M6 3L3 6l3 3M3 6h6.5a3.5 3.5 0 0 1 0 7H6",
  redo: "M10 3l3 3-3 3M13 6H6.5a3.5 3.5 0 0 0 0 7H10",
  download: "M8 2v8M4.5 7L8 10.5 11.5 7M3 13.5h10",
  renders: "M2 3h12v10H2zM5 3v10M11 3v10M2 6.3h3M2 9.7h3M11 6.3h3M11 9.7h3",
  target: "M8 1v3M8 12v3M1 8h3M12 8h3M11 8a3 3 0 1 1-6 0a3 3 0 1 1 6 0",
  trash: "M3 4.5h10M6.5 4.5V3h3v1.5M4.5 4.5l.6 8.5h5.8l.6-8.5M7 7v4M9 7v4",
  person: "M10.5 5.5a2.5 2.5 0 1 1-5 0a2.5 2.5 0 1 1 5 0M3 13.5c0-2.8 2.2-4 5-4s5 1.2 5 4",
  ring: "M14 8a6 6 0 1 1-12 0a6 6 0 1 1 12 0M11 8a3 3 0 1 1-6 0a3 3 0 1 1 6 0M8 2v3",
  loupe: "M11 6.5a4.5 4.5 0 1 1-9 0a4.5 4.5 0 1 1 9 0M9.8 9.8L14 14",
  points: "M2 5V2h3M11 2h3v3M14 11v3h-3M5 14H2v-3M7 8h2",
} as const;

export type IconName = keyof typeof PATHS | keyof typeof STROKES;

export function Icon({ name }: { name: IconName }): JSX.Element {
  const filled = name in PATHS;
  const path = filled ? PATHS[name as keyof typeof PATHS] : STROKES[name as keyof typeof STROKES];
  return (
    <svg class={filled ? "icon filled" : "icon"} viewBox="0 0 16 16" width="16" height="16" aria-hidden="true">
      <path d={path} />
    </svg>
  );
}
