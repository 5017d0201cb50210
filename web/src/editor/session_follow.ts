/** What an open shot reads, whenever its present state changes. */

import { effect, type ReadonlySignal, type Signal } from "@preact/signals";
import { wantedQuality, type PictureBox } from "../model/quality";
import type { Note, Shot } from "../model/shot";
import type { Service } from "../net/service";
import type { CacheFiller } from "./cache_filler";
import type { ShotDocument } from "./document";
import type { Fail } from "./fail";
import type { FrameNotes } from "./frame_notes";
import type { KeyEditing } from "./key_editing";
import type { CameraPhotography } from "./photography";
import type { Picks } from "./picks";
import type { Pictures } from "./pictures";
import type { Playhead } from "./playhead";
import { followWaits } from "./session_waits";
import type { Waits } from "./waits";

/** The parts of a session whose state is followed, and that read. */
interface Followed {
  readonly shot: Shot;
  readonly document: ShotDocument;
  readonly playhead: Playhead;
  readonly pictures: Pictures;
  readonly photography: CameraPhotography;
  readonly filler: CacheFiller;
  readonly picks: Picks;
  readonly keys: KeyEditing;
  readonly waits: Waits;
  readonly frameNotes: FrameNotes;
  readonly notes: Signal<readonly Note[]>;
  readonly selected: Signal<string | null>;
  readonly motion: ReadonlySignal<number>;
  readonly focusMaps: ReadonlySignal<boolean>;
  readonly box: ReadonlySignal<PictureBox | null>;
  readonly moving: ReadonlySignal<boolean>;
  readonly settled: ReadonlySignal<boolean>;
}

/** Reads what the present state needs, whenever it changes; returns what ends that. */
export function followSession(session: Followed, service: Pick<Service, "notes">, fail: Fail): () => void {
  const { document, playhead, pictures, photography } = session;
  let hasReadNotes = false;
  const readNotes = async (): Promise<void> => {
    try {
      session.notes.value = await service.notes(session.shot.id);
    } catch (error) {
      fail(error, () => void readNotes());
    }
  };
  void document.catchUp();
  const stops = [
    followWaits(session.waits, session),
    effect(() => {
      document.follow(playhead.time.value, session.moving.value, document.revision.value);
    }),
    effect(() => {
      const [box, time, revision] = [session.box.value, playhead.time.value, document.revision.value];
      const [unsaved, motion, focusMaps] = [document.unsaved.value, session.motion.value, session.focusMaps.value];
      // While an edit is under way the next request follows soon.
      const moving = session.moving.value || document.pending.value > 0;
      if (!box) return;
      const quality = wantedQuality(box, motion);
      pictures.request({ time, revision, unsaved, moving, focusMaps, quality });
    }),
    session.selected.subscribe(() => {
      session.keys.clear(); // what is removed or moved next is what was selected last
    }),
    effect(() => {
      photography.follow(playhead.time.value, session.moving.value, document.revision.value);
    }),
    effect(() => {
      // Not at each step of a drag: the next step would wait for it.
      const revision = document.revision.value;
      if (!document.dragging.value) document.refreshCurve(revision);
    }),
    effect(() => {
      session.frameNotes.keepUp();
    }),
    effect(() => {
      // Last of all, since it reads the whole shot; once.
      if ((session.settled.value || pictures.refusal !== null) && !hasReadNotes) {
        hasReadNotes = true;
        void readNotes();
      }
    }),
  ];
  return () => {
    for (const stop of stops) stop();
  };
}
