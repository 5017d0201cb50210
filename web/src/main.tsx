import "@fontsource-variable/inter/wght.css";
import { render } from "preact";
import { Editor } from "./editor/editor";
import { frameDrawn } from "./net/frame_drawn";
import { HttpService } from "./net/http";
import { followAddress, readAddress } from "./view/address";
import { App } from "./view/App";
import { listenToKeys } from "./view/keyboard";
import "./view/style/base.css";
import "./view/style/layout.css";
import "./view/style/controls.css";
import "./view/style/menus.css";
import "./view/style/camera.css";
import "./view/style/guides.css";
import "./view/style/viewer.css";
import "./view/style/plan.css";
import "./view/style/scopes.css";
import "./view/style/notes.css";
import "./view/style/timeline.css";
import "./view/style/company.css";
import "./view/style/ring.css";
import "./view/style/narrow.css";
import "./view/style/touch.css";

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
let newest = "";
followAddress(editor, (address) => {
  newest = address;
  void frameDrawn().then(() => {
    if (address === newest) history.replaceState(null, "", address);
  });
});
void editor.start(shot, camera, time);
