/** The whole editor: the shots, the open one, the remembered choices, and the last error. */

import { effect, signal, untracked } from "@preact/signals";
import { isPerson } from "../model/identity";
import type { LensSummary } from "../model/lens";
import { NO_LIBRARIES, type Libraries } from "../model/photography";
import type { TrashedShot } from "../model/shot";
import { complaintOf, HintError, isAbort, ServiceError, type Complaint } from "../net/errors";
import type { Download, Service } from "../net/service";
import type { View } from "../net/view";
import type { Fail } from "./fail";
import { Identity } from "./identity";
import { KeptPulls } from "./kept_pulls";
import { Layout } from "./layout";
import { Library, type Upload } from "./library";
import { Posters, type Poster } from "./posters";
import { localStore, Remembered } from "./remembered";
import { Session } from "./session";
import { Waits } from "./waits";

/** A drawing about something of a library. */
export interface Sheet {
  readonly title: string;
  readonly address: string;
}

/** Part of the dialog of renders that is open: the list, or the list and a new render. */
export type RendersView = "list" | "new";

/** A shot that is being opened; each try is another one. */
interface Opening {
  readonly shot: string;
  readonly camera: string | null;
}

export class Editor {
  readonly identity: Identity;
  readonly library: Library;
  readonly remembered = new Remembered();
  readonly layout = new Layout(this.remembered);
  readonly session = signal<Session | null>(null);
  /** The lens library; empty until it is there. */
  readonly lenses = signal<readonly LensSummary[]>([]);
  /** The libraries of films and bodies; empty until they are there. */
  readonly libraries = signal<Libraries>(NO_LIBRARIES);
  /** The sheet of a lens or a film that is open. */
  readonly sheet = signal<Sheet | null>(null);
  /** What is being opened. */
  readonly opening = signal<Opening | null>(null);
  /** What is waited for, each by its name. */
  readonly waits = new Waits();
  readonly complaint = signal<Complaint | null>(null);
  /** Reason why requests are held back for now, as the service says it; null where they are not. */
  readonly waiting = signal<string | null>(null);
  readonly helpOpen = signal(false);
  /** Whether the list of all commands is open. */
  readonly paletteOpen = signal(false);
  /** Whether the dialog of variants and payloads is open. */
  readonly choicesOpen = signal(false);
  /** Whether the dialog of what the cameras see is open. */
  readonly camerasOpen = signal(false);
  /** Part of the dialog of renders that is open; null where it is closed. */
  readonly rendersView = signal<RendersView | null>(null);
  /** Whether the list of who else is here is to have the keyboard. */
  readonly companyCalled = signal(false);
  /** How often a file of a shot was asked for; the page opens the browser's dialog then. */
  readonly fileRequests = signal(0);

  readonly service: Service;
  /** Does once more what the complaint is about. */
  #again = (): void => undefined;
  readonly #posters = new Posters(localStore());
  /** Puts back the pulls of deleted shots, by their ids. */
  readonly #forgotten = new Map<string, () => void>();
  #librariesRead: Promise<void> | null = null;

  /** @param reload loads the page anew, at its present address. */
  constructor(service: Service, reload: () => void) {
    this.service = service;
    this.identity = new Identity(service, reload);
    this.library = new Library(service, this.fail, this.waits);
    service.listen({
      onSignInNeeded: () => this.identity.ask(),
      onWaiting: (refusal) => (this.waiting.value = refusal?.message ?? null),
    });
    effect(() => {
      const successor = this.session.value?.document.successor.value;
      if (!successor) return;
      untracked(() => {
        this.#succeed(successor);
      });
    });
  }

  /** Shows an error, unless its request was cancelled on purpose. */
  readonly fail: Fail = (error, again) => {
    if (isAbort(error)) return;
    this.complaint.value = complaintOf(error);
    this.#again = again;
    // The list of shots has the reason, and what releases the shot.
    if (error instanceof ServiceError && error.status === 423) void this.library.refresh();
  };

  /** Finds out who is signed in, lists the shots and opens the given one, else the first. */
  async start(shot: string | null, camera: string | null, time: number | null): Promise<void> {
    const again = (): void => void this.start(shot, camera, time);
    try {
      await this.identity.refresh();
    } catch (error) {
      this.fail(error, again);
      return;
    }
    void this.#readLibraries();
    if (this.identity.noEdits.value === null) void this.library.refreshTrash();
    await this.library.refresh(again);
    const shots = this.library.shots.value ?? [];
    const chosen = shots.find((candidate) => candidate.id === shot) ?? shots[0];
    if (chosen) await this.#open(chosen.id, camera, time);
  }

  /** Does once more what failed last, and reads the libraries that could not be read. */
  retry(): void {
    this.complaint.value = null;
    void this.#readLibraries();
    this.#again();
  }

  /** Does something; where it fails, the person is told and can do it once more. */
  async attempt(act: () => Promise<void>): Promise<void> {
    try {
      await act();
    } catch (error) {
      this.fail(error, () => void this.attempt(act));
    }
  }

  /** Reads what has changed since the person was here last: who is signed in, and the edits of others. */
  async catchUp(): Promise<void> {
    const { who } = this.identity;
    if (who.value && isPerson(who.value)) await this.attempt(() => this.identity.refresh());
    if (who.value) void this.#readLibraries();
    await this.session.value?.document.catchUp();
  }

  /** Ends the session at the service once the edits under way are made. */
  async signOut(): Promise<void> {
    await this.session.value?.idle();
    this.#posters.clear();
    await this.attempt(() => this.identity.signOut());
    this.#posters.clear(); // a picture may have come meanwhile
  }

  /** Opens a shot; the one that was open stays until the new one is there. */
  async open(shot: string, camera: string | null = null, time: number | null = null): Promise<void> {
    this.complaint.value = null;
    this.layout.drawer.value = false;
    await this.#open(shot, camera, time);
  }

  async #open(shot: string, camera: string | null, time: number | null): Promise<void> {
    this.waits.of("opening")?.stop?.();
    const opening = { shot, camera };
    this.opening.value = opening;
    const name = this.library.shots.peek()?.find(({ id }) => id === shot)?.name ?? shot;
    try {
      const opened = await this.waits.run("opening", `Opening ${name}`, (abort) => this.service.open(shot, abort));
      if (this.opening.value !== opening) return; // another one was requested meanwhile
      const known = opened.cameras.some((candidate) => candidate.path === camera);
      const view = known ? camera : opened.defaultCamera;
      const before = this.session.value;
      before?.close();
      const session = new Session(
        this.service,
        opened,
        view,
        time ?? opened.range.start,
        this.fail,
        this.identity,
        this.remembered.pull,
        this.waits,
        { ...this.remembered.ring, kept: this.#keptPulls },
      );
      if (before?.shot.id === shot) session.frameNotes.follow(before.frameNotes);
      this.session.value = session;
    } catch (error) {
      if (this.opening.value === opening) this.fail(error, () => void this.open(shot, camera, time));
    } finally {
      if (this.opening.value === opening) this.opening.value = null;
    }
  }

  /** The pulls of whoever is signed in. */
  get #keptPulls(): KeptPulls {
    return new KeptPulls(localStore(), this.identity.who.peek()?.id ?? "");
  }

  /** How a shot looked when it was open here last; null where it was not. */
  posterOf(shot: string, camera: string | null): Poster | null {
    const who = this.identity.who.value;
    return who && this.#posters.find(who.id, shot, camera);
  }

  keepPoster(poster: Omit<Poster, "who">): void {
    const who = this.identity.who.peek();
    if (who) this.#posters.keep({ ...poster, who: who.id });
  }

  /** Looks through another camera of the open shot, at the same time. */
  async lookThrough(camera: string): Promise<void> {
    const session = this.session.value;
    if (session) await this.open(session.shot.id, camera, session.playhead.time.value);
  }

  /** Creates a camera from the view that a shot without one is shown in, and looks through it. */
  createCamera(): void {
    const session = this.session.value;
    if (!session) return;
    session.playhead.pause();
    const time = session.playhead.time.value;
    void session.document.edit("Create a camera", [{ type: "createCamera", time }]);
  }

  /** Copies the camera that the shot is seen through, and looks through the copy. */
  duplicateCamera(): void {
    const session = this.session.value;
    if (!session) return;
    session.playhead.pause();
    void session.document.edit("Duplicate the camera", [{ type: "duplicateCamera" }]);
  }

  /** Opens a view in place of the open session, which reads nothing from then on: its camera may be gone. */
  #succeed({ shot, camera }: View): void {
    const session = this.session.value;
    session?.close();
    void this.open(shot, camera, session?.playhead.time.value).finally(() => {
      // Where it was stopped, or could not be opened.
      if (session && this.session.value === session) this.session.value = null;
    });
  }

  async upload(files: Iterable<File>): Promise<void> {
    const refusal = this.identity.noEdits.value;
    if (refusal !== null) {
      this.fail(new HintError(refusal, "A key that may edit can add shots."), () => undefined);
      return;
    }
    const shots = await Promise.all([...files].map((file) => this.library.upload(file)));
    const last = shots.findLast((shot) => shot !== null);
    if (last) await this.open(last.id);
  }

  /** Sends a zip again, with one of the stages that it holds as its root, and opens it. */
  async chooseRoot(upload: Upload, root: string): Promise<void> {
    const shot = await this.library.chooseRoot(upload, root);
    if (shot) await this.open(shot.id);
  }

  async remove(shot: string): Promise<void> {
    await this.attempt(async () => {
      await this.library.remove(shot);
      const isOpen = this.session.value?.shot.id === shot;
      if (isOpen) this.session.value?.close(); // what is recorded becomes a take
      this.#posters.forget(shot);
      this.#forgotten.set(shot, this.#keptPulls.forget(shot));
      if (!isOpen) return;
      this.session.value = null;
      const next = this.library.shots.value?.[0];
      if (next) await this.open(next.id);
    });
  }

  /** Restores a deleted shot and opens it. */
  async restore(entry: TrashedShot): Promise<void> {
    await this.attempt(async () => {
      await this.library.restore(entry);
      this.#forgotten.get(entry.shot)?.();
      this.#forgotten.delete(entry.shot);
      await this.open(entry.shot);
    });
  }

  /** Releases a shot from quarantine and opens it. */
  async release(shot: string): Promise<void> {
    await this.attempt(async () => {
      await this.library.release(shot);
      await this.open(shot);
    });
  }

  /** Reads the libraries that are not there yet. */
  #readLibraries(): Promise<void> {
    const read = async (): Promise<void> => {
      if (this.lenses.value.length === 0) this.lenses.value = await this.service.lenses();
      if (this.libraries.value === NO_LIBRARIES) this.libraries.value = await this.service.libraries();
    };
    this.#librariesRead ??= this.attempt(read).then(() => {
      this.#librariesRead = null;
    });
    return this.#librariesRead;
  }

  /** Makes a download of what is edited and hands it to `save`. */
  async export(
    what: string,
    make: (abort: AbortSignal) => Promise<Download>,
    save: (download: Download) => void,
  ): Promise<void> {
    try {
      const made = this.waits.run("download", `Making ${what}`, async (abort) => {
        await this.session.value?.idle();
        abort.throwIfAborted();
        return make(abort);
      });
      save(await made);
    } catch (error) {
      this.fail(error, () => void this.export(what, make, save));
    }
  }
}
