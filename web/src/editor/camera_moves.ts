/** Moves of the camera by hand: shown at once, and one edit at their end. */

import { signal } from "@preact/signals";
import { moveCamera, moved, pivotOf, poseOf, type Drag, type HeldCamera, type MoveKind } from "../model/camera_moves";
import type { Change, Changes } from "../model/changes";
import type { FocusPoint } from "../model/shot";
import type { Service } from "../net/service";
import type { CameraPlaceReader } from "./camera_place";
import type { ShotDocument } from "./document";
import type { Fail } from "./fail";
import type { Playhead } from "./playhead";

/** What of a session the moves act on. */
interface Moved {
  readonly document: ShotDocument;
  readonly playhead: Playhead;
  readonly aspect: number;
  readonly cameraPlace: CameraPlaceReader;
  readonly selectedPoint: { peek: () => FocusPoint | null };
}

/** A hand on the camera. */
interface Hand {
  readonly time: number;
  /** The camera as it is by now; null until it is known. */
  held: HeldCamera | null;
  /** Moves that wait for it. */
  readonly waiting: ((held: HeldCamera) => HeldCamera)[];
  readonly reading: AbortController;
  /** Whether the last of them is a key. */
  isKeyed: boolean;
  /** The changes that are shown. */
  unsaved: Changes | null;
}

export class CameraMoves {
  /** Whether a drag of the picture and the arrow keys move the camera. */
  readonly isOn = signal(false);
  /** What a drag does then. */
  readonly kind = signal<MoveKind>("orbit");
  /** Whether a move is a key at the frame; else all of the camera's way is moved. */
  readonly isKeyed = signal(false);
  readonly #service: Service;
  readonly #session: Moved;
  readonly #fail: Fail;
  #hand: Hand | null = null;
  #known: Promise<void> = Promise.resolve();

  constructor(service: Service, session: Moved, fail: Fail) {
    [this.#service, this.#session, this.#fail] = [service, session, fail];
  }

  /** Why the camera cannot be moved; null where it can. */
  get refusal(): string | null {
    const { document } = this.#session;
    return document.noEdits.value ?? (document.hasLens ? null : "There is no camera to move: create one first.");
  }

  /** Moves the camera, and shows it so; `end` makes that an edit. */
  move(kind: MoveKind, by: Drag): void {
    this.#act((held) => moved(held, kind, by));
  }

  /** Makes what the hand has done one edit. */
  async end(): Promise<void> {
    const hand = this.#hand;
    await this.#known;
    if (!hand || this.#hand !== hand) return;
    this.#hand = null;
    if (!hand.unsaved) return;
    const { document } = this.#session;
    const { unsaved } = hand;
    document.unsaved.value = unsaved;
    const edited = document.edit(hand.isKeyed ? "Key the camera" : "Move the camera", unsaved, unsaved);
    document.dragging.value = false;
    await edited;
  }

  /** Leaves the camera where it was. */
  cancel(): void {
    const hand = this.#hand;
    this.#hand = null;
    hand?.reading.abort();
    if (hand?.unsaved && this.#session.document.unsaved.peek() === hand.unsaved) this.#session.document.endPreview();
  }

  /** Lets what a focus point follows fill two thirds of the picture. */
  async frame(point: string): Promise<void> {
    const keyed = this.isKeyed.peek();
    const { playhead, aspect } = this.#session;
    await this.#change(`Frame ${point}`, { type: "frameSubject", point, time: playhead.time.peek(), keyed, aspect });
  }

  /** Why there is no key to take away where the playhead is; null where there is. */
  get noKeyHere(): string | null {
    return this.refusal ?? (this.#session.cameraPlace.here.value ? null : "The camera has no key at this frame.");
  }

  /** Takes the key away that is where the playhead is. */
  async unkey(): Promise<void> {
    const key = this.#session.cameraPlace.here.peek();
    if (key) await this.#change("Take the camera’s key away", { type: "unkeyCamera", time: key.time });
  }

  /** Why the camera cannot be taken back to where the shot has it; null where it can. */
  get noWayBack(): string | null {
    return this.refusal ?? this.#session.cameraPlace.noWayBack.value;
  }

  /** Takes the camera back to where the shot itself has it, for all time. */
  async reset(): Promise<void> {
    await this.#change("Take the camera back", { type: "resetCameraPlace" });
  }

  /** Sets a key where the camera stands. */
  key(): Promise<void> {
    this.#act((held) => held, true);
    return this.end();
  }

  /** Makes a change by itself, after what a hand has done. */
  async #change(label: string, change: Change): Promise<void> {
    if (this.refusal !== null) return;
    this.#session.playhead.pause();
    await this.end();
    const { document } = this.#session;
    document.unsaved.value = [change];
    await document.edit(label, document.unsaved.value, document.unsaved.value);
  }

  #act(move: (held: HeldCamera) => HeldCamera, isKeyed = this.isKeyed.peek()): void {
    if (this.refusal !== null) return;
    this.#hand ??= this.#take();
    this.#hand.isKeyed = isKeyed;
    if (this.#hand.held) this.#show(this.#hand, move(this.#hand.held));
    else this.#hand.waiting.push(move);
  }

  /** Takes hold of the camera as the edits before have left it. */
  #take(): Hand {
    const { playhead } = this.#session;
    playhead.pause();
    const reading = new AbortController();
    const hand: Hand = { time: playhead.time.peek(), held: null, waiting: [], reading, isKeyed: false, unsaved: null };
    this.#known = this.#read(hand).catch((error: unknown) => {
      if (this.#hand === hand) this.#hand = null;
      this.#fail(error, () => undefined);
    });
    return hand;
  }

  async #read(hand: Hand): Promise<void> {
    const { document, aspect, selectedPoint } = this.#session;
    await document.idle();
    const view = await this.#service.fromAbove.topView(document.view, hand.time, hand.reading.signal);
    if (this.#hand !== hand) return;
    const pose = poseOf(view);
    const focusM = 1 / view.axis.focusW - view.setBackM;
    const pivotM = pivotOf(pose, selectedPoint.peek()?.positionM ?? null, focusM);
    let held: HeldCamera = { pose, pivotM, widthPerM: view.edges[1] - view.edges[0], aspect };
    for (const move of hand.waiting) held = move(held);
    if (hand.waiting.length > 0) this.#show(hand, held);
    else hand.held = held;
  }

  #show(hand: Hand, held: HeldCamera): void {
    hand.held = held;
    hand.unsaved = [moveCamera(held.pose, hand.time, hand.isKeyed)];
    this.#session.document.preview(hand.unsaved);
  }
}
