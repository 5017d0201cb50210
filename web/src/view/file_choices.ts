/** Files that the open shot gets from the person's machine. */

import type { Session } from "../editor/session";

/** Asks for the focus curve of another tool. */
export function importCurve({ mounting }: Session): void {
  chooseFile(".csv,.json,.otio", (file) => {
    mounting.curve(file);
  });
}

/** Asks for the prescription of a lens. */
export function mountLensFile({ mounting }: Session): void {
  chooseFile(".dat,.zmx,.seq,.txt,.roa,.json,.lens", (file) => {
    mounting.lensFile(file);
  });
}

/** The last input that asked, which its browser may forget where nothing holds it. */
let asking: HTMLInputElement;

function chooseFile(accept: string, take: (file: File) => void): void {
  const input = (asking = Object.assign(document.createElement("input"), { type: "file", accept }));
  input.addEventListener("change", () => {
    const [file] = input.files ?? [];
    if (file) take(file);
  });
  asking.click();
}
