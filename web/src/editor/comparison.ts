/** The picture that the one on screen is compared with: a snapshot, or what another camera, lens or stop would show. */

import { computed, effect, signal } from "@preact/signals";
import { changesOf, type Comparing, type Gain, type Otherwise } from "../model/comparison";
import { wantedQuality, type PictureBox } from "../model/quality";
import type { LiveLink, LivePicture } from "../net/live_link";
import type { Service } from "../net/service";
import type { ShotDocument } from "./document";
import type { Fail } from "./fail";
import type { Displayed } from "./pictures";

/** Snapshots that are kept; the oldest goes when there is one more. */
const MOST_SNAPSHOTS = 8;

/** A picture that was kept, with the settings that it was made with. */
export interface Snapshot {
  readonly id: number;
  readonly said: string;
  readonly bitmap: ImageBitmap;
}

/** The session that is compared in. */
export interface Compared {
  readonly document: ShotDocument;
  readonly playhead: { readonly time: { readonly value: number } };
  readonly pictures: {
    readonly displayed: { readonly value: Displayed | null; peek: () => Displayed | null };
    readonly refusal: string | null;
  };
  readonly settled: { readonly value: boolean };
  readonly motion: { readonly value: number };
  readonly box: { readonly value: PictureBox | null };
  readonly pointsSetStop: { readonly value: boolean };
}

export class Comparison {
  readonly mode = signal<Comparing>("off");
  /** Part of the width on the left of the divider, which shows the present picture. */
  readonly divider = signal(0.5);
  readonly gain = signal<Gain>("4");
  /** Whether B alone is shown, where one is shown after the other. */
  readonly showsOther = signal(false);
  /** Pictures that were kept, the newest first. */
  readonly snapshots = signal<readonly Snapshot[]>([]);
  /** Number of the snapshot that is compared; null for what would be otherwise. */
  readonly chosen = signal<number | null>(null);
  readonly otherwise = signal<Otherwise>({ camera: null, lens: null, fStop: null });
  /** What would be otherwise, drawn; null until it is. */
  readonly #drawn = signal<ImageBitmap | null>(null);
  /** Whether the picture of what would be otherwise is the best one. */
  readonly #isBest = signal(false);
  readonly snapshot = computed(() => this.snapshots.value.find(({ id }) => id === this.chosen.value) ?? null);
  /** The other picture; null while there is none. */
  readonly other = computed(
    () => this.snapshot.value?.bitmap ?? (this.chosen.value === null ? this.#drawn.value : null),
  );
  /** Whether the other picture is as good as it gets. */
  readonly isBest = computed(() => this.chosen.value !== null || this.#isBest.value);

  readonly #service: Service;
  readonly #session: Compared;
  readonly #fail: Fail;
  #link: { readonly live: LiveLink; readonly camera: string | null } | null = null;
  #serial = 0;
  #shownSerial = 0;
  readonly #stop: () => void;

  constructor(service: Service, session: Compared, fail: Fail) {
    [this.#service, this.#session, this.#fail] = [service, session, fail];
    this.#stop = effect(() => {
      this.#follow();
    });
  }

  /** Keeps the present picture, which is compared from then on; null where there is none. */
  async take(said: string): Promise<Snapshot | null> {
    const shown = this.#session.pictures.displayed.peek();
    if (!shown) return null;
    const bitmap = await createImageBitmap(shown.bitmap);
    const snapshot = { id: (this.#serial += 1), said, bitmap };
    const [kept, gone] = [[snapshot, ...this.snapshots.peek()], this.snapshots.peek().slice(MOST_SNAPSHOTS - 1)];
    this.snapshots.value = kept.slice(0, MOST_SNAPSHOTS);
    this.chosen.value = snapshot.id;
    for (const old of gone) old.bitmap.close();
    return snapshot;
  }

  /** Drops a snapshot. */
  drop({ id, bitmap }: Snapshot): void {
    this.snapshots.value = this.snapshots.value.filter((snapshot) => snapshot.id !== id);
    if (this.chosen.value === id) this.chosen.value = this.snapshots.value[0]?.id ?? null;
    bitmap.close();
  }

  /** Goes to a way of comparing, or away from it. */
  toggle(mode: Comparing): void {
    this.mode.value = this.mode.value === mode ? "off" : mode;
  }

  /** Shows B alone, or A. */
  swap(): void {
    if (this.mode.value === "flicker") this.showsOther.value = !this.showsOther.value;
    else this.toggle("other");
  }

  close(): void {
    this.#stop();
    this.#hangUp();
    for (const { bitmap } of this.snapshots.value) bitmap.close();
  }

  /** Draws what would be otherwise, once the best present picture is there, so that it does not have to wait. */
  #follow(): void {
    const { document, playhead, settled, motion, box, pointsSetStop, pictures } = this.#session;
    if (this.mode.value === "off" || this.chosen.value !== null || pictures.refusal !== null) {
      this.#hangUp();
      return;
    }
    const [otherwise, time, size, revision] = [
      this.otherwise.value,
      playhead.time.value,
      box.value,
      document.revision.value,
    ];
    const camera = otherwise.camera ?? document.view.camera;
    this.#isBest.value = false;
    if (!settled.value || size === null || revision < 0) {
      this.#link?.live.cancel();
      return;
    }
    const quality = wantedQuality(size, motion.value);
    const unsaved = changesOf(otherwise, time, pointsSetStop.value);
    this.#linkTo(camera).request({ time, quality, unsaved, moving: false, focusMaps: false });
  }

  #linkTo(camera: string | null): LiveLink {
    if (this.#link?.camera === camera) return this.#link.live;
    this.#hangUp();
    const live = this.#service.live(
      { shot: this.#session.document.view.shot, camera },
      {
        onPicture: (picture) => this.#show(picture),
        onReadout: () => undefined,
        onError: (error) => {
          this.#fail(error, () => {
            this.#hangUp();
            this.otherwise.value = { ...this.otherwise.peek() };
          });
        },
        onOpen: () => undefined,
      },
    );
    this.#link = { live, camera };
    return live;
  }

  async #show({ blob, stage }: LivePicture): Promise<void> {
    const serial = (this.#serial += 1);
    const bitmap = await createImageBitmap(blob);
    if (serial < this.#shownSerial || !this.#link) {
      bitmap.close();
      return;
    }
    this.#shownSerial = serial;
    this.#drawn.peek()?.close();
    this.#drawn.value = bitmap;
    this.#isBest.value = stage === "final";
  }

  #hangUp(): void {
    this.#link?.live.close();
    this.#link = null;
    this.#drawn.peek()?.close();
    this.#drawn.value = null;
  }
}
