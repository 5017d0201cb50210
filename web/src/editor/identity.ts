/** Who is signed in, and the question for a key where the service needs one. */

import { computed, signal } from "@preact/signals";
import { isPerson, isSamePerson, refusalOf, type Who } from "../model/identity";
import { complaintOf, ServiceError } from "../net/errors";
import type { Service } from "../net/service";

/** The question that is open, and the requests that wait for its answer. */
interface Question {
  readonly answer: Promise<boolean>;
  readonly settle: (signedIn: boolean) => void;
}

export class Identity {
  /** Null until it is known. */
  readonly who = signal<Who | null>(null);
  /** Whether a key is asked for. */
  readonly asking = signal(false);
  /** Whether a key is being tried. */
  readonly trying = signal(false);
  /** Reason why the last key was not taken. */
  readonly refusal = signal<string | null>(null);

  /** Reasons why shots may not be edited, or pictures drawn; null where they may. */
  readonly noEdits = computed(() => refusalOf(this.who.value, "edit"));
  readonly noPictures = computed(() => refusalOf(this.who.value, "render"));

  readonly #service: Service;
  readonly #reload: () => void;
  #question: Question | null = null;
  /** Whether the question was left without an answer: requests fail from then on. */
  #isDismissed = false;

  /** @param reload loads the page anew, at its present address. */
  constructor(service: Service, reload: () => void) {
    [this.#service, this.#reload] = [service, reload];
  }

  /** Reads who is signed in; the page is loaded anew where somebody else is, as from another tab. */
  async refresh(): Promise<void> {
    this.#take(await this.#service.whoAmI());
  }

  /** Asks for a key, unless that was dismissed before. Resolves to whether somebody has signed in. */
  ask(): Promise<boolean> {
    if (this.#isDismissed) return Promise.resolve(false);
    this.#question ??= question();
    this.asking.value = true;
    return this.#question.answer;
  }

  /** Asks for a key again after that was dismissed. */
  askAgain(): void {
    this.asking.value = true;
  }

  /** Tries a key; where it is taken, the requests that wait are sent again. */
  async signIn(key: string): Promise<void> {
    this.trying.value = true;
    this.refusal.value = null;
    try {
      const who = await this.#service.signIn(key);
      // What failed meanwhile is read again by a new page.
      if (this.#isDismissed) this.#reload();
      else if (this.#take(who)) this.#settle(true);
    } catch (error) {
      this.refusal.value = error instanceof ServiceError ? error.message : complaintOf(error).message;
    } finally {
      this.trying.value = false;
    }
  }

  /** Goes on without a key: the requests that wait fail. */
  dismiss(): void {
    if (!this.asking.peek()) return;
    this.#isDismissed = true;
    this.#settle(false);
  }

  async signOut(): Promise<void> {
    await this.#service.signOut();
    this.#reload();
  }

  /** Returns whether the page may go on: what it shows or has still to save may belong to somebody else. */
  #take(who: Who): boolean {
    const before = this.who.peek();
    if (before && isPerson(before) && !isSamePerson(before, who)) {
      this.#reload();
      return false;
    }
    this.who.value = who;
    return true;
  }

  #settle(signedIn: boolean): void {
    this.asking.value = false;
    this.refusal.value = null;
    this.#question?.settle(signedIn);
    this.#question = null;
  }
}

function question(): Question {
  let settle: Question["settle"] = () => undefined;
  const answer = new Promise<boolean>((resolve) => (settle = resolve));
  return { answer, settle };
}
