/** Notes of a session whose service a test sets. */

import { signal } from "@preact/signals";
import { ShotDocument } from "@/editor/document";
import { FrameNotes } from "@/editor/frame_notes";
import { Playhead } from "@/editor/playhead";
import type { FrameNote, Stroke } from "@/model/frame_notes";
import { SHOT, type FakeService } from "./fake_service";

export const LINE: Stroke = { points: [[0.1, 0.2]], colour: "red", width: 0.006 };

export function note(id: string, time: number, more: Partial<FrameNote> = {}): FrameNote {
  const rest = { camera: null, text: id, strokes: [], author: "", created: "", modified: "", resolved: false };
  return { id, time, ...rest, ...more };
}

export interface Opened {
  readonly notes: FrameNotes;
  readonly document: ShotDocument;
  readonly playhead: Playhead;
  readonly fail: ReturnType<typeof vi.fn>;
}

export function notesOf(fake: FakeService, shot = SHOT, camera = "/cam"): Opened {
  const fail = vi.fn();
  const playhead = new Playhead(SHOT.range, 7, () => true);
  const document = new ShotDocument(fake.service, shot, camera, signal(7), fail);
  return { notes: new FrameNotes(fake.service, document, playhead, fail), document, playhead, fail };
}
