/** The page: one component for each region of the screen. */

import type { ComponentChildren, JSX } from "preact";
import { useState } from "preact/hooks";
import type { Editor } from "../editor/editor";
import { Help } from "./dialogs/Help";
import { Palette } from "./dialogs/Palette";
import { Inspector } from "./panels/Inspector";
import { SignIn } from "./dialogs/SignIn";
import { SheetDialog } from "./dialogs/SheetDialog";
import { ShotFiles, Shots } from "./dialogs/Shots";
import { Timeline } from "./timeline/Timeline";
import { TopBar } from "./TopBar";
import { Viewer } from "./viewer/Viewer";

export function App({ editor }: { editor: Editor }): JSX.Element {
  const session = editor.session.value;
  return (
    <DropTarget onFiles={(files) => void editor.upload(files)}>
      <TopBar editor={editor} />
      <Shots editor={editor} />
      <Viewer editor={editor} key={session?.shot.id ?? ""} />
      <Inspector editor={editor} />
      <Timeline editor={editor} />
      <Help editor={editor} />
      <Palette editor={editor} />
      <ShotFiles editor={editor} />
      <SheetDialog editor={editor} />
      <SignIn editor={editor} />
    </DropTarget>
  );
}

/** The whole window takes files. */
function DropTarget({
  onFiles,
  children,
}: {
  onFiles: (files: File[]) => void;
  children: ComponentChildren;
}): JSX.Element {
  const [over, setOver] = useState(false);
  const holdsFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
  return (
    <div
      class="app"
      onDragOver={(event) => {
        if (!holdsFiles(event)) return;
        event.preventDefault();
        setOver(true);
      }}
      onDragLeave={(event) => {
        if (!(event.relatedTarget instanceof Node)) setOver(false);
      }}
      onDrop={(event) => {
        event.preventDefault();
        setOver(false);
        const files = [...(event.dataTransfer?.files ?? [])];
        if (files.length > 0) onFiles(files);
      }}
    >
      {children}
      {over && <div class="drop-veil">Drop to open: .usda, .usdc, .usdz, or a .zip with what the shot references</div>}
    </div>
  );
}
