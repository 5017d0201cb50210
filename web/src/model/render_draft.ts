/** A render as it is typed, before it is sent. */

import { aovsOf, faultOfAovs } from "./aovs";
import { formatsOf, isGraded, productsOf, type ChosenProducts } from "./deliverables";
import { faultOfFrames } from "./frame_range";
import type { Render, RenderRequest } from "./renders";
import type { FrameRange } from "./time";

/** What is typed in each field. */
export interface RenderDraft extends ChosenProducts {
  readonly name: string;
  readonly frames: string;
  readonly width: string;
  readonly rays: string;
  readonly priority: string;
  /** Names of declared AOVs. */
  readonly aovs: readonly string[];
  /** Names of primvars, such as "st, displayColor". */
  readonly primvars: string;
  /** Renders that have to be done before. */
  readonly after: readonly Render[];
}

export type DraftField = keyof RenderDraft;
/** Fields of words and numbers. */
export type TypedField = Exclude<DraftField, keyof ChosenProducts | "aovs" | "after">;

/** Whether the files that are chosen can hold AOVs. */
export function holdsAovs(draft: RenderDraft): boolean {
  return formatsOf(draft).includes("exr");
}

/** Whether facts can be burnt into the pictures that are chosen. */
export function holdsFacts(draft: RenderDraft): boolean {
  return isGraded(formatsOf(draft));
}

/** What the page's picture is of, at rest. */
export interface RenderedView {
  readonly shot: string;
  readonly camera: string | null;
  readonly layers: number;
  readonly supersample: number;
  /** Moments of the shutter's opening; 1 stops motion. */
  readonly motion: number;
}

/** What is wrong with a draft: at a field, or with all of it. */
export interface DraftFault {
  readonly field: DraftField | null;
  readonly message: string;
}

/** Whole frames of a range in the service's words, such as "1-96". */
export function framesOf({ start, end }: FrameRange): string {
  const [first, last] = [Math.ceil(start), Math.floor(end)];
  return first < last ? `${first}-${last}` : `${first}`;
}

/** Whole numbers, each with an example and the service's limits. */
const WHOLE_NUMBERS: readonly (readonly [TypedField, string, number, number])[] = [
  ["width", "1920", 1, 8192],
  ["rays", "100", 1, Infinity],
  ["priority", "50", 0, 100],
];

/** Renders that one may wait for. */
const MOST_NEEDED = 16;

/** Faults that the page sees by itself; what a picture may cost is the service's. */
export function faultsIn(draft: RenderDraft): readonly DraftFault[] {
  const range = draft.frames.trim();
  const isTooMany = draft.after.length > MOST_NEEDED;
  return [
    ...faultAt("frames", range === "" ? null : faultOfFrames(range)),
    ...WHOLE_NUMBERS.flatMap((number) => faultOfNumber(draft, ...number)),
    ...faultAt("primvars", holdsAovs(draft) ? faultOfAovs(draft) : null),
    ...faultAt("made", draft.made.length > 0 ? null : "Choose what to make."),
    ...faultAt("after", isTooMany ? `A render waits for ${MOST_NEEDED} others at most.` : null),
  ];
}

function faultAt(field: DraftField, message: string | null): DraftFault[] {
  return message === null ? [] : [{ field, message }];
}

function faultOfNumber(
  draft: RenderDraft,
  field: TypedField,
  example: string,
  least: number,
  most: number,
): DraftFault[] {
  const text = draft[field];
  if (!/^\s*\d{1,9}\s*$/.test(text)) return [{ field, message: `Type a whole number, such as ${example}.` }];
  if (Number(text) < least) return [{ field, message: `Type ${least} or more.` }];
  return Number(text) > most ? [{ field, message: `Type ${most} or less.` }] : [];
}

/** The request of a draft without faults: the picture that the page shows, in other frames, size and files. */
export function requestOf(draft: RenderDraft, view: RenderedView): RenderRequest {
  const { shot, camera, layers, supersample, motion } = view;
  const frames = draft.frames.trim();
  const aovs = holdsAovs(draft) ? aovsOf(draft) : [];
  const burnIn = holdsFacts(draft) ? draft.burnIn : [];
  const products = productsOf(draft);
  return {
    shot,
    ...(camera !== null && { camera }),
    name: draft.name.trim(),
    ...(frames !== "" && { frames }),
    width: Number(draft.width),
    rays: Number(draft.rays),
    formats: formatsOf(draft),
    ...(aovs.length > 0 && { aovs }),
    ...(burnIn.length > 0 && { burnIn }),
    ...(products.length > 0 && { products }),
    priority: Number(draft.priority),
    ...(draft.after.length > 0 && { after: draft.after.map(({ id }) => id) }),
    engine: "lens",
    layers,
    supersample,
    motion,
    motionBy: "moments", // a file may take its time, as a download
  };
}

/** Where the service's finding about a request belongs: `body.width` is about the field `width`. */
export function fieldOf(path: string | null): DraftField | null {
  const last = path?.split(".").findLast((part) => !/^\d+$/.test(part)); // a number is a place in a list
  return FIELDS[last ?? ""] ?? null;
}

const FIELDS: Readonly<Record<string, DraftField>> = {
  name: "name",
  frames: "frames",
  width: "width",
  rays: "rays",
  formats: "formats",
  products: "made",
  burnIn: "burnIn",
  priority: "priority",
  aovs: "primvars", // those that are not typed are right
  after: "after",
  render: "after", // one that is not there
};
