/** The page: one component for each region of the screen. */

import type { ComponentChildren, JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { Editor } from "../editor/editor";
import { FOLDABLE, type Layout } from "../editor/layout";
import { Help } from "./dialogs/Help";
import { Palette } from "./dialogs/Palette";
import { CamerasDialog } from "./dialogs/CamerasDialog";
import { ChoicesDialog } from "./dialogs/ChoicesDialog";
import { RendersDialog } from "./dialogs/RendersDialog";
import { Inspector } from "./panels/Inspector";
import { SignIn } from "./dialogs/SignIn";
import { SheetDialog } from "./dialogs/SheetDialog";
import { ShotFiles, Shots } from "./dialogs/Shots";
import { Timeline } from "./timeline/Timeline";
import { Tooltip } from "./Tooltip";
import { TopBar } from "./TopBar";
import { Viewer } from "./viewer/Viewer";

export function App({ editor }: { editor: Editor }): JSX.Element {
  const session = editor.session.value;
  const { layout } = editor;
  useNarrow(layout);
  return (
    <DropTarget layout={layout} onFiles={(files) => void editor.upload(files)}>
      <TopBar editor={editor} />
      {layout.isShown("shots") && <Shots editor={editor} />}
      {layout.isNarrow.value && layout.drawer.value && <Veil layout={layout} />}
      <div class="beside" inert={layout.isNarrow.value && layout.drawer.value}>
        <Viewer editor={editor} key={session?.shot.id ?? ""} />
        {layout.isShown("settings") && <Inspector editor={editor} />}
        <Timeline editor={editor} />
      </div>
      <Help editor={editor} />
      <Palette editor={editor} />
      <ShotFiles editor={editor} />
      <SheetDialog editor={editor} />
      <ChoicesDialog editor={editor} />
      <CamerasDialog editor={editor} />
      <RendersDialog editor={editor} />
      <SignIn editor={editor} />
      <Tooltip />
    </DropTarget>
  );
}

/** Width of the window below which the list of shots covers the picture, px; that of the style sheet. */
const NARROW_PX = 900;

function useNarrow(layout: Layout): void {
  useEffect(() => {
    const query = matchMedia(`(max-width: ${NARROW_PX - 1}px)`);
    const changed = (): void => {
      layout.isNarrow.value = query.matches;
    };
    changed();
    query.addEventListener("change", changed);
    return () => {
      query.removeEventListener("change", changed);
    };
  }, [layout]);
}

/** What is beside the list of shots where it covers the picture; a click there, or Escape, takes the list away. */
function Veil({ layout }: { layout: Layout }): JSX.Element {
  useEffect(() => {
    const pressed = (event: KeyboardEvent): void => {
      if (event.key !== "Escape" || event.defaultPrevented) return;
      event.preventDefault();
      layout.drawer.value = false;
    };
    addEventListener("keydown", pressed, { capture: true });
    return () => {
      removeEventListener("keydown", pressed, { capture: true });
    };
  }, [layout]);
  useEffect(() => {
    const before = document.activeElement;
    document.querySelector<HTMLElement>(".shots button")?.focus();
    return () => {
      if (before instanceof HTMLElement) before.focus();
    };
  }, []);
  return <div class="veil" onClick={() => (layout.drawer.value = false)} />;
}

/** The whole window takes files. */
function DropTarget({
  layout,
  onFiles,
  children,
}: {
  layout: Layout;
  onFiles: (files: File[]) => void;
  children: ComponentChildren;
}): JSX.Element {
  const [over, setOver] = useState(false);
  const { shots, settings, curve } = layout.sizes;
  const sizes = {
    ...(shots.value > 0 && { "--shots": `${shots.value}px` }),
    ...(settings.value > 0 && { "--settings": `${settings.value}px` }),
    ...(curve.value > 0 && { "--curve": `${curve.value}px` }),
  };
  const folded = FOLDABLE.filter((panel) => !layout.isShown(panel)).map((panel) => ` no-${panel}`);
  const holdsFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
  return (
    <div
      class={`app${folded.join("")}`}
      style={sizes}
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
