/** What a render delivers: files of its frames, and products, which the service makes as the last part of the job. */

import type { components } from "../net/schema";
import { FACTS } from "./burn_in";
import { FILE_CHOICES, type FileChoice, type FrameFormat } from "./frame_files";

type Render = components["schemas"]["Render"];
type RenderRequest = components["schemas"]["RenderRequest"];
export type ProductName = NonNullable<RenderRequest["products"]>[number];
export type RenderProduct = NonNullable<Render["products"]>[number];
export type BurntFact = NonNullable<RenderRequest["burnIn"]>[number];

/** Products, and the formats of each; the first one is the usual one. */
export const PRODUCT_CHOICES = {
  movie: {
    name: "Movie",
    help: "of graded frames, which are stored too",
    formats: { mp4: "H.264 (.mp4)", mov: "ProRes 422 HQ (.mov)", webm: "VP9 (.webm)" },
  },
  "contact-sheet": {
    name: "Contact sheet",
    help: "a PNG of graded frames, which are stored too",
    formats: { png: "PNG" },
  },
  "focus-report": {
    name: "Focus report",
    help: "who is sharp when; needs no picture",
    formats: { html: "To read and print (.html)", csv: "Spreadsheet (.csv)", json: "JSON" },
  },
  "focus-curve": {
    name: "Focus curve",
    help: "needs no picture",
    formats: {
      usda: "USD layer, spline (.usda)",
      json: "JSON",
      csv: "Spreadsheet (.csv)",
      otio: "Editorial (.otio)",
      opentrackio: "Set, OpenTrackIO (.json)",
    },
  },
} as const satisfies Record<string, { name: string; help: string; formats: Readonly<Record<string, string>> }>;

export type ProductKind = keyof typeof PRODUCT_CHOICES;
export const PRODUCT_KINDS = Object.keys(PRODUCT_CHOICES) as readonly ProductKind[];
export type Made = "frames" | ProductKind;

/** Facts that can be burnt in, as the page shows them, and the distance in feet. */
export const BURNT_FACTS: readonly BurntFact[] = FACTS.flatMap((fact) =>
  fact === "focus" ? [fact, "focusFt" as const] : [fact],
);

/** What is chosen to be made. */
export interface ChosenProducts {
  readonly made: readonly Made[];
  /** Files of each frame, if frames are made. */
  readonly formats: FileChoice;
  /** Format of each product, if it is made. */
  readonly productFormats: Readonly<Record<ProductKind, string>>;
  /** Facts in the corners of the graded pictures. */
  readonly burnIn: readonly BurntFact[];
}

const STANDARD: ChosenProducts = {
  made: ["frames"],
  formats: "exr",
  productFormats: { movie: "mp4", "contact-sheet": "png", "focus-report": "html", "focus-curve": "usda" },
  burnIn: [],
};

/** Files of each frame: those that are chosen, and the graded ones that movies and sheets are made of. */
export function formatsOf({ made, formats }: Pick<ChosenProducts, "made" | "formats">): readonly FrameFormat[] {
  const chosen: readonly FrameFormat[] = made.includes("frames") ? FILE_CHOICES[formats].formats : [];
  const needsGraded = made.includes("movie") || made.includes("contact-sheet");
  return needsGraded && !isGraded(chosen) ? [...chosen, "png"] : chosen;
}

/** Whether there are graded pictures, which facts are burnt into. */
export function isGraded(formats: readonly FrameFormat[]): boolean {
  return formats.some((format) => format !== "exr");
}

/** The products that are chosen, by the service's names. */
export function productsOf({ made, productFormats }: ChosenProducts): readonly ProductName[] {
  return PRODUCT_KINDS.filter((kind) => made.includes(kind)).map(
    (kind) => `${kind}.${productFormats[kind]}` as ProductName,
  );
}

/** What is chosen as words between commas, to be remembered. */
export function wordsOf(chosen: ChosenProducts): string {
  const frames = chosen.made.includes("frames") ? [`frames.${chosen.formats}`] : [];
  return [...frames, ...productsOf(chosen), ...chosen.burnIn.map((fact) => `burnIn.${fact}`)].join(",");
}

/** What words say that was chosen; unknown words are left out, and without any frames are made. */
export function chosenProducts(words: string): ChosenProducts {
  let found: ChosenProducts = { ...STANDARD, made: [] };
  for (const word of words.split(",")) {
    const [kind = "", format = ""] = word.split(".");
    const fact = BURNT_FACTS.find((each) => each === format);
    if (kind === "frames" && format in FILE_CHOICES) {
      found = { ...found, made: [...found.made, kind], formats: format as FileChoice };
    } else if (isKind(kind) && format in PRODUCT_CHOICES[kind].formats) {
      found = { ...found, made: [...found.made, kind], productFormats: { ...found.productFormats, [kind]: format } };
    } else if (kind === "burnIn" && fact !== undefined) {
      found = { ...found, burnIn: [...found.burnIn, fact] };
    }
  }
  return found.made.length > 0 ? found : { ...found, made: STANDARD.made };
}

function isKind(word: string): word is ProductKind {
  return word in PRODUCT_CHOICES;
}

/** A product for people: "Movie (.mp4)". */
export function productInWords(name: string): string {
  const [kind = "", format = ""] = name.split(".");
  const noun = isKind(kind) ? PRODUCT_CHOICES[kind].name : kind;
  return `${noun} (${format === "opentrackio" ? "OpenTrackIO" : `.${format}`})`;
}

/** How far a product is, for people. */
export function productStateInWords({ state, error }: RenderProduct): string {
  switch (state) {
    case "waiting":
      return "waits";
    case "running":
      return "is being made…";
    case "done":
      return "done";
    case "failed":
      return `failed: ${error ?? "no reason is known"}`;
    case "canceled":
      return "given up";
  }
}

/** How many products of a render are in each of some states. */
export function countProducts({ products = [] }: Pick<Render, "products">, states: readonly string[]): number {
  return products.filter(({ state }) => states.includes(state)).length;
}
