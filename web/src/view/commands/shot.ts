/** Commands of shots and cameras, of downloads, and of undo. */

import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { isPerson } from "../../model/identity";
import { save } from "../hooks";
import { always, onShot, type Command } from "./command";

/** Opens the shot that is so many places further in the list. */
function openNext(editor: Editor, by: 1 | -1): void {
  const shots = editor.library.shots.value ?? [];
  const open = editor.opening.value?.shot ?? editor.session.value?.shot.id;
  const at = shots.findIndex(({ id }) => id === open);
  const next = at < 0 ? shots[0] : shots.at((at + by) % shots.length);
  if (next) void editor.open(next.id);
}

function severalShots({ editor }: { editor: Editor }): string | null {
  return (editor.library.shots.value?.length ?? 0) > 1 ? null : "There is no other shot.";
}

/** A file that is made of the open shot, and the heading that it has in the menu of downloads. */
export interface DownloadItem {
  readonly group: string;
  readonly what: string;
  readonly keys: string;
  readonly refusal: (session: Session) => string | null;
  readonly make: (session: Session, abort: AbortSignal) => ReturnType<Session["downloads"]["edits"]>;
}

const none = (): null => null;
const noPicture = ({ pictures }: Session): string | null => pictures.refusal;

const CURVE = "Focus curve";
const FRAME = "This frame";

export const DOWNLOADS: readonly DownloadItem[] = [
  item(CURVE, "USD layer, spline (.usda)", "Ctrl S", none, ({ downloads }, abort) => downloads.curve("usda", abort)),
  item(CURVE, "JSON", "Alt J", none, ({ downloads }, abort) => downloads.curve("json", abort)),
  item(CURVE, "Spreadsheet (.csv)", "Alt C", none, ({ downloads }, abort) => downloads.curve("csv", abort)),
  item(CURVE, "Editorial, OpenTimelineIO (.otio)", "Alt O", none, ({ downloads }, abort) =>
    downloads.curve("otio", abort),
  ),
  item(CURVE, "Set, OpenTrackIO (.json)", "Alt T", none, ({ downloads }, abort) =>
    downloads.curve("opentrackio", abort),
  ),
  item("Edits", "Edit layer (.usda)", "Ctrl Shift S", none, ({ downloads }, abort) => downloads.edits(abort)),
  item(FRAME, "Graded (.png)", "Ctrl E", noPicture, ({ downloads }, abort) => downloads.frame("png", abort)),
  item(FRAME, "Scene-linear (.exr)", "Ctrl Shift E", noPicture, ({ downloads }, abort) =>
    downloads.frame("exr", abort),
  ),
];

function item(
  group: string,
  what: string,
  keys: string,
  refusal: DownloadItem["refusal"],
  make: DownloadItem["make"],
): DownloadItem {
  return { group, what, keys, refusal, make };
}

const SHOTS: readonly Command[] = [
  always("Shot", {
    name: "Add a shot…",
    keys: ["Ctrl O"],
    refusal: ({ editor }) => editor.identity.noEdits.value,
    act: ({ editor }) => {
      editor.fileRequests.value += 1;
    },
  }),
  always("Shot", {
    name: "Next shot",
    keys: ["Alt PageDown"],
    refusal: severalShots,
    act: ({ editor }) => {
      openNext(editor, 1);
    },
  }),
  always("Shot", {
    name: "Previous shot",
    keys: ["Alt PageUp"],
    refusal: severalShots,
    act: ({ editor }) => {
      openNext(editor, -1);
    },
  }),
  onShot("Shot", {
    name: "Next camera",
    keys: ["Shift C"],
    refusal: ({ shot, camera }) =>
      shot.cameras.some(({ path }) => path !== camera) ? null : "There is no other camera.",
    act: ({ shot, camera }, { editor }) => {
      const at = shot.cameras.findIndex(({ path }) => path === camera);
      const next = shot.cameras[(at + 1) % shot.cameras.length];
      if (next) void editor.lookThrough(next.path);
    },
  }),
  onShot("Shot", {
    name: "Cameras side by side…",
    keys: ["Alt Shift C"],
    refusal: ({ shot }) => (shot.cameras.length > 0 ? null : "The shot has no camera."),
    act: ({ playhead }, { editor }) => {
      playhead.pause();
      editor.camerasOpen.value = true;
    },
  }),
  onShot("Shot", {
    name: "Variants and payloads…",
    keys: ["Alt V"],
    act: (_, { editor }) => {
      editor.choicesOpen.value = true;
    },
  }),
  onShot("Shot", {
    name: "Create a camera from this view",
    keys: ["Shift N"],
    refusal: ({ document, camera }) =>
      document.noEdits.value ?? (camera === null ? null : "The shot is seen through a camera already."),
    act: (_, { editor }) => {
      editor.createCamera();
    },
  }),
];

const FILES = DOWNLOADS.map(({ group, what, keys, refusal, make }) =>
  onShot("Shot", {
    name: `Download: ${group.toLowerCase()}, ${what}`,
    keys: [keys],
    refusal: (session, { editor }) =>
      editor.waits.of("download") === null ? refusal(session) : "A file is being made.",
    act: (session, { editor }) => void editor.export(what, (abort) => make(session, abort), save),
  }),
);

const RENDERS: readonly Command[] = [
  always("Shot", {
    name: "Renders",
    keys: ["Alt R"],
    act: ({ editor }) => {
      editor.rendersView.value = "list";
    },
  }),
  onShot("Shot", {
    name: "Render many frames…",
    keys: ["Alt Shift R"],
    refusal: noPicture,
    act: (_, { editor }) => {
      editor.rendersView.value = "new";
    },
  }),
  onShot("Shot", {
    name: "Deliver: frames, movie, contact sheet, focus report, focus curve…",
    keys: ["Alt Shift D"],
    refusal: noPicture,
    act: (_, { editor }) => {
      editor.rendersView.value = "new";
    },
  }),
];

const LEAVING = always("Shot", {
  name: "Sign out",
  keys: ["Alt Q"],
  refusal: ({ editor: { identity } }) =>
    identity.who.value && isPerson(identity.who.value) ? null : "Nobody is signed in.",
  act: ({ editor }) => void editor.signOut(),
});

const STOPPING = always("Edit", {
  name: "Stop what is waited for",
  keys: ["Escape"],
  refusal: ({ editor }) => (editor.waits.newest === null ? "Nothing that can be stopped is waited for." : null),
  act: ({ editor }) => {
    editor.waits.stopNewest();
  },
});

const UNDO: readonly Command[] = [
  onShot("Edit", {
    name: "Undo",
    keys: ["Ctrl Z"],
    wantsKey: ({ frameNotes }) => !frameNotes.isDrawing.value, // it is that of strokes then
    refusal: ({ document }) =>
      document.noEdits.value ?? (document.undoLabel.value === null ? "There is nothing to undo." : null),
    act: ({ document }) => void document.undo(),
  }),
  onShot("Edit", {
    name: "Redo",
    keys: ["Ctrl Shift Z", "Ctrl Y"],
    refusal: ({ document }) =>
      document.noEdits.value ?? (document.redoLabel.value === null ? "There is nothing to redo." : null),
    act: ({ document }) => void document.redo(),
  }),
];

export const SHOT_COMMANDS: readonly Command[] = [...SHOTS, ...FILES, ...RENDERS, LEAVING, STOPPING, ...UNDO];
