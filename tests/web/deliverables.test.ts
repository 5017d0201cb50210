import {
  chosenProducts,
  formatsOf,
  productInWords,
  productsOf,
  productStateInWords,
  wordsOf,
} from "@/model/deliverables";
import { faultsIn, requestOf, type RenderDraft } from "@/model/render_draft";
import { hasEnded, isTaken, progressInWords, stateInWords } from "@/model/renders";
import { render } from "./render_fixtures";

function draft(words: string): RenderDraft {
  const typed = { name: "", frames: "1-4", width: "64", rays: "4", priority: "50", after: [] };
  return { ...typed, ...chosenProducts(words), aovs: ["depth"], primvars: "" };
}
const view = { shot: "demo", camera: null, layers: 4, supersample: 0, motion: 1 };
const product = (name: string, state: string, error: string | null = null): unknown => ({
  name,
  state,
  error,
  sizeBytes: null,
});
const withProducts = (change: object, ...products: unknown[]): ReturnType<typeof render> =>
  render({ ...change, products: products as NonNullable<ReturnType<typeof render>["products"]> });

describe("what is chosen to be made", () => {
  it("is frames where nothing was remembered, or nothing that is known", () => {
    expect(chosenProducts("").made).toEqual(["frames"]);
    expect(chosenProducts("film.9,movie.gif,burnIn.mood")).toEqual(chosenProducts(""));
  });

  it("is remembered as it was", () => {
    const words = "frames.both,movie.mov,focus-report.csv,focus-curve.otio,burnIn.shot,burnIn.focusFt";
    expect(wordsOf(chosenProducts(words))).toBe(words);
    expect(wordsOf(chosenProducts("focus-curve.usda"))).toBe("focus-curve.usda");
  });

  it.each([
    ["frames.exr,movie.mp4", ["exr", "png"]],
    ["frames.jpeg,contact-sheet.png", ["jpeg"]],
    ["movie.webm", ["png"]],
    ["focus-report.html,focus-curve.csv", []],
  ])("has the files that it needs: %s", (words, formats) => {
    expect(formatsOf(chosenProducts(words))).toEqual(formats);
  });

  it("is asked for, with burn-ins where pictures are graded and AOVs where some are EXR", () => {
    const all = requestOf(draft("frames.exr,movie.mp4,focus-report.html,burnIn.shot"), view);
    expect(all).toMatchObject({ formats: ["exr", "png"], products: ["movie.mp4", "focus-report.html"] });
    expect([all.aovs, all.burnIn]).toEqual([["depth"], ["shot"]]);
    const report = requestOf(draft("focus-report.csv,burnIn.shot"), view);
    expect([report.formats, report.products, report.aovs, report.burnIn]).toEqual([
      [],
      ["focus-report.csv"],
      undefined,
      undefined,
    ]);
    expect(requestOf(draft("frames.exr"), view)).not.toHaveProperty("products");
  });

  it("has to be something", () => {
    const nothing = { ...draft(""), made: [] };
    expect(faultsIn(nothing)).toEqual([{ field: "made", message: "Choose what to make." }]);
    expect(productsOf(nothing)).toEqual([]);
  });
});

describe("products of a render", () => {
  it("are told with their states", () => {
    expect(["movie.mp4", "focus-curve.opentrackio"].map(productInWords)).toEqual([
      "Movie (.mp4)",
      "Focus curve (OpenTrackIO)",
    ]);
    expect(productStateInWords({ name: "movie.mp4", state: "failed", error: "no disk", sizeBytes: null })).toBe(
      "failed: no disk",
    );
  });

  it("keep it under way, and are made again", () => {
    const making = withProducts({ ready: 0, done: 4, state: "running" }, product("movie.mp4", "running"));
    expect([hasEnded(making), isTaken("cancel", making), isTaken("remove", making)]).toEqual([false, true, false]);
    expect([stateInWords(making, []), progressInWords(making)]).toEqual([
      "Making files",
      "4 of 4 frames, 0 of 1 product",
    ]);
    const failed = withProducts({ ready: 0, done: 4, state: "failed" }, product("movie.mp4", "failed", "no disk"));
    expect([hasEnded(failed), isTaken("retry", failed)]).toEqual([true, true]);
    const report = withProducts({ ready: 0, count: 0, state: "done" }, product("focus-report.csv", "done"));
    expect(progressInWords(report)).toBe("1 of 1 product");
  });
});
