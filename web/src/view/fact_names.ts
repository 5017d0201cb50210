/** Names of the facts that are burnt into pictures. */

import type { Fact } from "../model/burn_in";

export const FACT_NAMES: Readonly<Record<Fact, string>> = {
  shot: "Shot",
  camera: "Camera",
  lens: "Lens",
  focal: "Focal length",
  stop: "Stop",
  focus: "Focus distance",
  film: "Film",
  revision: "Revision",
  date: "Date",
  frame: "Frame",
  timecode: "Timecode",
};
