/** The shots of the service, and the uploads. */

import { signal } from "@preact/signals";
import type { ShotSummary, TrashedShot } from "../model/shot";
import { complaintOf, isAbort, ServiceError, type Complaint } from "../net/errors";
import type { Service } from "../net/service";
import type { Fail } from "./fail";
import { Waits, type Wait } from "./waits";

/** A file on its way. */
export interface Upload {
  readonly id: number;
  readonly name: string;
  /** Its wait; null before it and after it. */
  readonly wait: Wait | null;
  readonly complaint: Complaint | null;
  /** Stages of a zip of which one has to be chosen as its root, for it to be sent again. */
  readonly candidates: readonly string[];
  readonly file: File;
}

export class Library {
  readonly shots = signal<readonly ShotSummary[] | null>(null);
  /** The deleted shots that can be restored, the last one first. */
  readonly trash = signal<readonly TrashedShot[]>([]);
  /** The shot that was just deleted, while it is in the trash. */
  readonly removed = signal<TrashedShot | null>(null);
  readonly uploads = signal<readonly Upload[]>([]);

  readonly #service: Service;
  readonly #fail: Fail;
  readonly #waits: Waits;
  #serial = 0;

  constructor(service: Service, fail: Fail, waits = new Waits()) {
    this.#service = service;
    this.#fail = fail;
    this.#waits = waits;
  }

  /** @param again does once more what it was read for, where that fails. */
  async refresh(again = (): void => void this.refresh()): Promise<void> {
    try {
      this.shots.value = await this.#service.shots();
    } catch (error) {
      this.#fail(error, again);
    }
  }

  /** Sends a file. Resolves to the new shot, or to null where it was refused or given up. */
  async upload(file: File): Promise<ShotSummary | null> {
    this.#serial += 1;
    const id = this.#serial;
    const upload = { id, name: file.name, wait: null, complaint: null, candidates: [], file };
    this.uploads.value = [...this.uploads.value, upload];
    return this.#send(upload, null);
  }

  /** Sends a zip again, with one of its candidates as root. Resolves as `upload` does. */
  async chooseRoot(upload: Upload, root: string): Promise<ShotSummary | null> {
    this.#change(upload.id, { complaint: null, candidates: [] });
    return this.#send(upload, root);
  }

  async #send({ id, name, file }: Upload, root: string | null): Promise<ShotSummary | null> {
    try {
      const shot = await this.#waits.run("upload", `Sending ${name}`, (abort, told, wait) => {
        this.#change(id, { wait });
        const onProgress = (progress: number): void => {
          told.progress.value = progress < 1 ? progress : null;
          if (progress >= 1) told.name.value = `Reading ${name}`;
        };
        return this.#service.upload({ file, root }, onProgress, abort);
      });
      this.dismiss(id);
      await this.refresh();
      return shot;
    } catch (error) {
      if (isAbort(error)) this.dismiss(id);
      else if (error instanceof ServiceError && error.code === "ambiguous_root" && error.subjects.length > 0)
        this.#change(id, { candidates: error.subjects });
      else this.#change(id, { complaint: complaintOf(error) });
      return null;
    } finally {
      this.#change(id, { wait: null });
    }
  }

  /** Gives up an upload, or takes a refused one off the list. */
  dismiss(id: number): void {
    this.uploads.value.find((upload) => upload.id === id)?.wait?.stop?.();
    this.uploads.value = this.uploads.value.filter((upload) => upload.id !== id);
  }

  async remove(shot: string): Promise<void> {
    await this.#service.removeShot(shot);
    await Promise.all([this.refresh(), this.refreshTrash()]);
    this.removed.value = this.trash.value.find((entry) => entry.shot === shot) ?? null;
  }

  async refreshTrash(): Promise<void> {
    try {
      this.trash.value = await this.#service.trash();
    } catch (error) {
      this.#fail(error, () => void this.refreshTrash());
    }
  }

  /** Restores a deleted shot. */
  async restore(entry: TrashedShot): Promise<void> {
    this.removed.value = null;
    await this.#service.restore(entry.id);
    await Promise.all([this.refresh(), this.refreshTrash()]);
  }

  /** Lets a shot in quarantine be opened again. */
  async release(shot: string): Promise<void> {
    await this.#service.release(shot);
    await this.refresh();
  }

  #change(id: number, change: Partial<Upload>): void {
    this.uploads.value = this.uploads.value.map((upload) => (upload.id === id ? { ...upload, ...change } : upload));
  }
}
