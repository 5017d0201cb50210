import "@fontsource-variable/inter/wght.css";
import { effect } from "@preact/signals";
import { render } from "preact";
import { Editor } from "./editor/editor";
import { HttpService } from "./net/http";
import { readAddress, writeAddress } from "./view/address";
import { App } from "./view/App";
import { listenToKeys } from "./view/keyboard";
import "./view/style/base.css";
import "./view/style/layout.css";
import "./view/style/controls.css";
import "./view/style/camera.css";
import "./view/style/viewer.css";
import "./view/style/timeline.css";

const editor = new Editor(new HttpService(), () => {
  location.reload();
});
const root = document.getElementById("app");
if (!root) throw new Error("The page has no #app to draw in.");

render(<App editor={editor} />, root);
listenToKeys(window, editor);
// On return to the page, show what other editors have changed meanwhile.
addEventListener("focus", () => void editor.catchUp());

const { shot, camera, time } = readAddress(location.href);
void editor.start(shot, camera, time).then(() => {
  effect(() => {
    const session = editor.session.value;
    // While playing the address keeps still: browsers allow few changes of it in a second.
    if (session?.playhead.playing.value || session?.playhead.scrubbing.value) return;
    // Without a list of shots the address still says what is to be opened.
    if (editor.library.shots.value === null) return;
    history.replaceState(
      null,
      "",
      writeAddress(session && { ...session.document.view, time: session.playhead.time.value }),
    );
  });
});
