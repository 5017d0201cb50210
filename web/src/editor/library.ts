/** The shots of the service, and the uploads. */

import { signal } from "@preact/signals";
import type { ShotSummary, TrashedShot } from "../model/shot";
import { complaintOf, isAbort, type Complaint } from "../net/errors";
import type { Service } from "../net/service";

/** A file on its way. */
export interface Upload {
  readonly id: number;
  readonly name: string;
  /** 0 to 1 of the bytes; at 1 the service is reading it. */
  readonly progress: number;
  readonly complaint: Complaint | null;
  readonly abort: AbortController;
}

export class Library {
  readonly shots = signal<readonly ShotSummary[] | null>(null);
  /** The deleted shots that can be restored, the last one first. */
  readonly trash = signal<readonly TrashedShot[]>([]);
  /** The shot that was just deleted, while it is in the trash. */
  readonly removed = signal<TrashedShot | null>(null);
  readonly uploads = signal<readonly Upload[]>([]);

  readonly #service: Service;
  readonly #fail: (error: unknown) => void;
  #serial = 0;

  constructor(service: Service, fail: (error: unknown) => void) {
    this.#service = service;
    this.#fail = fail;
  }

  async refresh(): Promise<void> {
    try {
      this.shots.value = await this.#service.shots();
    } catch (error) {
      this.#fail(error);
    }
  }

  /** Sends a file. Resolves to the new shot, or to null where it was refused or given up. */
  async upload(file: File): Promise<ShotSummary | null> {
    this.#serial += 1;
    const id = this.#serial;
    const abort = new AbortController();
    this.uploads.value = [...this.uploads.value, { id, name: file.name, progress: 0, complaint: null, abort }];
    try {
      const shot = await this.#service.upload(
        file,
        (progress) => {
          this.#change(id, { progress });
        },
        abort.signal,
      );
      this.dismiss(id);
      await this.refresh();
      return shot;
    } catch (error) {
      if (isAbort(error)) this.dismiss(id);
      else this.#change(id, { complaint: complaintOf(error) });
      return null;
    }
  }

  /** Gives up an upload, or takes a refused one off the list. */
  dismiss(id: number): void {
    this.uploads.value.find((upload) => upload.id === id)?.abort.abort();
    this.uploads.value = this.uploads.value.filter((upload) => upload.id !== id);
  }

  async remove(shot: string): Promise<boolean> {
    try {
      await this.#service.removeShot(shot);
      await Promise.all([this.refresh(), this.refreshTrash()]);
      this.removed.value = this.trash.value.find((entry) => entry.shot === shot) ?? null;
      return true;
    } catch (error) {
      this.#fail(error);
      return false;
    }
  }

  async refreshTrash(): Promise<void> {
    try {
      this.trash.value = await this.#service.trash();
    } catch (error) {
      this.#fail(error);
    }
  }

  /** Restores a deleted shot; resolves to whether that went well. */
  async restore(entry: TrashedShot): Promise<boolean> {
    this.removed.value = null;
    return this.#changing(async () => {
      await this.#service.restore(entry.id);
      await this.refreshTrash();
    });
  }

  /** Lets a shot in quarantine be opened again; resolves to whether that went well. */
  async release(shot: string): Promise<boolean> {
    return this.#changing(() => this.#service.release(shot));
  }

  async #changing(act: () => Promise<void>): Promise<boolean> {
    try {
      await act();
      await this.refresh();
      return true;
    } catch (error) {
      this.#fail(error);
      return false;
    }
  }

  #change(id: number, change: Partial<Upload>): void {
    this.uploads.value = this.uploads.value.map((upload) => (upload.id === id ? { ...upload, ...change } : upload));
  }
}
