/** What is put on the camera: a lens, a body, or the focus curve of a file. */

import type { LensSummary } from "../model/lens";
import type { BodySummary } from "../model/photography";
import { base64Of } from "../net/files";
import type { ShotDocument } from "./document";

export class Mounting {
  readonly #document: ShotDocument;

  constructor(document: ShotDocument) {
    this.#document = document;
  }

  /** Puts a lens of the library on the camera, or with null the thin lens. */
  lens(lens: LensSummary | null): void {
    void this.#document.edit(`Mount ${lens?.title ?? "the thin lens"}`, [
      { type: "setCamera", values: { lens: lens?.name ?? null } },
    ]);
  }

  lensFile(file: File): void {
    void this.#document.edit(`Mount ${file.name}`, async () => [
      { type: "mountLensFile", fileName: file.name, content: await base64Of(file) },
    ]);
  }

  body(body: BodySummary): void {
    void this.#document.edit(`Mount the ${body.title}`, [{ type: "setCamera", values: { body: body.name } }]);
  }

  /** Gives the camera the focus curve of a file; it is focused by hand then. */
  curve(file: File): void {
    void this.#document.edit(`Import ${file.name}`, async () => [
      { type: "importCurve", content: await base64Of(file), gaps: "interpolate" },
    ]);
  }
}
