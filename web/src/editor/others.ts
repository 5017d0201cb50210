/** Edits of others: they are shown as soon as the service tells of them, and nothing is done here meanwhile. */

import { effect, signal, untracked } from "@preact/signals";
import type { EventLink } from "../net/shot_events";
import type { Service } from "../net/service";
import type { ShotDocument } from "./document";

/** Revision of the edits that was told and is still to be read; null for whichever they have. */
interface Told {
  readonly revision: string | null;
}

export class Others {
  readonly #told = signal<Told | null>(null);
  readonly #document: ShotDocument;
  readonly #link: EventLink;
  readonly #stop: () => void;

  constructor(service: Pick<Service, "edits">, document: ShotDocument) {
    this.#document = document;
    this.#link = service.edits(document.shot.id, {
      onEdits: (revision) => (this.#told.value = { revision }),
    });
    this.#stop = effect(() => {
      const told = this.#told.value;
      if (told === null || !document.resting.value) return;
      untracked(() => void this.#catchUp(told));
    });
  }

  close(): void {
    this.#stop();
    this.#link.close();
  }

  async #catchUp(told: Told): Promise<void> {
    this.#told.value = null;
    if (told.revision === this.#document.history.peek().revision) return;
    // An edit that began meanwhile is waited for; its own answer may be older than what was told.
    if (!(await this.#document.catchUp(told.revision))) this.#told.value ??= told;
  }
}
