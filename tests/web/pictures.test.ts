import { signal } from "@preact/signals";
import { ShotDocument } from "@/editor/document";
import { Pictures } from "@/editor/pictures";
import type { Changes } from "@/model/changes";
import type { FocusPoint } from "@/model/shot";
import { restQuality } from "@/model/quality";
import { errorOf } from "@/net/errors";
import { FakeService, FOCUS_MAP, SHOT } from "./fake_service";
import { point } from "./points";

const REST = restQuality(800, 400);
const PIP = point("pip");
const UNSAVED: Changes = [{ type: "movePoint", name: "hero", place: [0.5, 0.5], time: 1 }];

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("createImageBitmap", () => Promise.resolve({ close: () => undefined }));
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

function opened(onFail: (error: unknown) => void = fail): {
  fake: FakeService;
  pictures: Pictures;
  document: ShotDocument;
  want: (time: number, moving: boolean, unsaved?: Changes, focusMaps?: boolean) => void;
} {
  const fake = new FakeService();
  const document = new ShotDocument(fake.service, SHOT, "/cam", signal(1), fail);
  const pictures = new Pictures(fake.service, document, onFail);
  const want = (time: number, moving: boolean, unsaved: Changes = [], focusMaps = false): void => {
    pictures.request({ time, revision: document.revision.value, quality: REST, moving, unsaved, focusMaps });
  };
  return { fake, pictures, document, want };
}

function fail(error: unknown): void {
  throw error;
}

describe("the points of a picture", () => {
  it("do not hold it up", async () => {
    const { fake, pictures, want } = opened();
    let tell: (points: FocusPoint[]) => void = fail;
    const read = new Promise<FocusPoint[]>((resolve) => (tell = resolve));
    vi.spyOn(fake, "focusPoints").mockReturnValue(read);
    want(5, true);
    await fake.show("preview");
    expect(pictures.displayed.value).toMatchObject({ time: 5, points: [] });
    tell([PIP]);
    await vi.waitFor(() => {
      expect(pictures.displayed.value).toMatchObject({ time: 5, points: [PIP] });
    });
  });

  it("are those of the picture before until they are read", async () => {
    const { fake, pictures, want } = opened();
    vi.spyOn(fake, "focusPoints")
      .mockResolvedValueOnce([PIP])
      .mockReturnValue(new Promise(() => undefined));
    want(5, true);
    await fake.show("preview");
    await vi.waitFor(() => {
      expect(pictures.displayed.value?.points).toEqual([PIP]);
    });
    want(6, true);
    await fake.show("preview");
    expect(pictures.displayed.value).toMatchObject({ time: 6, points: [PIP] });
  });
});

describe("focus maps", () => {
  it("come with the first picture and go on with those that follow", async () => {
    const { fake, pictures, want } = opened();
    want(5, false, [], true);
    expect(fake.requests.at(-1)?.focusMaps).toBe(true);
    await fake.show("preview", -1, FOCUS_MAP);
    const first = pictures.displayed.value?.focusMap;
    expect(first).toMatchObject({ width: 2, height: 2, filmMmPerPx: 0.1 });
    await fake.show("refining");
    expect(pictures.displayed.value).toMatchObject({ stage: "refining", focusMap: first });
    await fake.show("final", -1, FOCUS_MAP);
    expect(pictures.displayed.value?.focusMap).not.toBe(first);
  });

  it("are not those of another frame", async () => {
    const { fake, pictures, want } = opened();
    want(5, true, [], true);
    await fake.show("preview", -1, FOCUS_MAP);
    want(6, true, [], true);
    await fake.show("preview");
    expect(pictures.displayed.value).toMatchObject({ time: 6, focusMap: null });
  });

  it("are kept with pictures, the exact one rather than a coarse one", async () => {
    const { fake, pictures, want } = opened();
    want(5, false, [], true);
    await fake.show("final", -1, FOCUS_MAP);
    want(6, false, [], true);
    await fake.show("final", -1, FOCUS_MAP);
    want(5, true, [], true);
    await vi.waitFor(() => {
      expect(pictures.displayed.value).toMatchObject({ time: 5, focusMap: { width: 2 } });
    });
    expect(fake.requests).toHaveLength(2);
    expect(fake.mapRequests).toEqual([]);
  });

  it("are not wanted any more where the picture has one", () => {
    const { fake, want } = opened();
    want(5, false, [], true);
    want(5, false, [], false);
    expect(fake.requests).toHaveLength(1);
  });
});

describe("a focus map that did not come with the picture", () => {
  it("is read by itself, while the exact picture stays", async () => {
    const { fake, pictures, want } = opened();
    want(5, false);
    await fake.show("final");
    want(5, false, [], true);
    await vi.waitFor(() => {
      expect(pictures.displayed.value).toMatchObject({ stage: "final", focusMap: { width: 2 } });
    });
    expect(pictures.busy.value).toBe(false);
    expect(fake.requests).toHaveLength(1);
    expect(fake.mapRequests).toEqual([5]);
  });

  it("is read though there is that of a preview", async () => {
    const { fake, pictures, want } = opened();
    want(5, false);
    await fake.show("final");
    want(8, false);
    await fake.show("final");
    want(5, true, [], true);
    await fake.show("preview", -1, FOCUS_MAP);
    want(5, false, [], true);
    await vi.waitFor(() => {
      expect(fake.mapRequests).toEqual([5]);
    });
    expect(pictures.displayed.value).toMatchObject({ time: 5, stage: "final" });
  });

  it("is read for the probe, and for pictures that are not live", async () => {
    const { fake, pictures, want } = opened();
    fake.listener?.onOpen(false);
    want(5, false);
    await vi.waitFor(() => {
      expect(pictures.displayed.value).toMatchObject({ stage: "final", focusMap: null });
    });
    pictures.readMap();
    await vi.waitFor(() => {
      expect(pictures.displayed.value).toMatchObject({ focusMap: { height: 2 } });
    });
    pictures.readMap();
    expect(fake.mapRequests).toEqual([5]);
  });

  it("cannot be read, and the picture is shown", async () => {
    const failures: unknown[] = [];
    const { fake, pictures, want } = opened((error) => void failures.push(error));
    want(5, true, [], true);
    await fake.show("preview", -1, FOCUS_MAP.slice(0, 60));
    expect(pictures.displayed.value).toMatchObject({ time: 5, focusMap: null });
    expect(failures).toHaveLength(1);
  });
});

describe("live pictures", () => {
  it("are shown as they come, until the exact one", async () => {
    const { fake, pictures, want } = opened();
    want(5, false);
    expect(pictures.busy.value).toBe(true);
    await fake.show("preview");
    expect(pictures.displayed.value).toMatchObject({ time: 5, stage: "preview", width: 200 });
    await fake.show("refining");
    await fake.show("final");
    expect(pictures.displayed.value).toMatchObject({ time: 5, stage: "final", width: 800, tookMs: 80 });
    expect(pictures.busy.value).toBe(false);
  });

  it("are requested once while a hand moves and again when it rests, however often the same is", () => {
    const { fake, want } = opened();
    for (const moving of [true, true, false, false, true]) want(5, moving);
    expect(fake.requests.map((request) => request.moving)).toEqual([true, false]);
  });

  it("of what is unsaved are shown and not kept", async () => {
    const { fake, pictures, want } = opened();
    want(1, true, UNSAVED);
    await fake.show("preview");
    expect(pictures.displayed.value?.unsaved).toBe(UNSAVED);
    expect(pictures.keptTimes.value).toEqual([]);
    want(1, true);
    expect(fake.requests.at(-1)?.unsaved).toEqual([]);
  });
});

describe("pictures that were shown once", () => {
  it("and were exact are shown again without asking", async () => {
    const { fake, pictures, want } = opened();
    for (const time of [1, 2]) {
      want(time, false);
      await fake.show("final");
    }
    want(1, true);
    want(2, false);
    await vi.advanceTimersByTimeAsync(0);
    expect(fake.requests).toHaveLength(2);
    expect(pictures.displayed.value?.time).toBe(2);
    expect(pictures.keptTimes.value.toSorted()).toEqual([1, 2]);
  });

  it("and were poor are requested again, and never replace a better one", async () => {
    const { fake, pictures, want } = opened();
    want(1, false);
    await fake.show("preview");
    want(2, true);
    want(1, true);
    expect(fake.requests).toHaveLength(3);
    await fake.show("final", 0);
    await fake.show("preview", 2);
    want(3, true);
    want(1, false);
    await vi.advanceTimersByTimeAsync(0);
    expect(pictures.displayed.value).toMatchObject({ time: 1, stage: "final" });
  });

  it("before an edit are not shown after it", async () => {
    const { fake, document, want } = opened();
    want(1, false);
    await fake.show("final");
    document.refresh();
    want(1, false);
    expect(fake.requests).toHaveLength(2);
  });
});

describe("pictures that are kept", () => {
  it("stay on screen, whatever arrives of earlier requests", async () => {
    const { fake, pictures, want } = opened();
    want(11, false);
    await fake.show("final");
    want(10, false);
    await fake.show("preview");
    want(11, false);
    expect(fake.cancelled).toBe(1);
    expect(pictures.busy.value).toBe(false);
    await vi.advanceTimersByTimeAsync(0);
    for (const stage of ["refining", "final"] as const) {
      await fake.show(stage, 1);
      expect(pictures.displayed.value).toMatchObject({ time: 11, stage: "final" });
    }
    want(10, false); // which came too late to be shown, and is there now
    await vi.advanceTimersByTimeAsync(0);
    expect(pictures.displayed.value).toMatchObject({ time: 10, stage: "final" });
    expect(fake.requests).toHaveLength(2);
  });
});

describe("where pictures do not come live", () => {
  it("a draft is requested, and the whole one after a rest", async () => {
    const { fake, pictures, want } = opened();
    fake.listener?.onOpen(false);
    want(5, false);
    await vi.advanceTimersByTimeAsync(200);
    expect(pictures.displayed.value).toMatchObject({ time: 5, stage: "preview" });
    await vi.advanceTimersByTimeAsync(2000);
    expect(pictures.displayed.value).toMatchObject({ time: 5, stage: "final", quality: REST });
    expect(fake.frames.map(({ quality }) => quality.width < REST.width)).toEqual([true, false]);
  });

  it("the whole one of an earlier request is not requested", async () => {
    const { fake, pictures, want } = opened();
    want(11, false);
    await fake.show("final");
    fake.listener?.onOpen(false);
    want(10, false);
    want(11, false);
    await vi.advanceTimersByTimeAsync(2000);
    expect(pictures.displayed.value).toMatchObject({ time: 11, stage: "final" });
    expect(fake.frames.filter(({ quality }) => quality.width === REST.width && quality.rays === REST.rays)).toEqual([]);
  });

  it("while things move the whole one is never requested, and unsaved changes not at all", async () => {
    const { fake, want } = opened();
    fake.listener?.onOpen(false);
    for (const time of [1, 2, 3]) {
      want(time, true);
      await vi.advanceTimersByTimeAsync(200);
    }
    want(3, true, UNSAVED);
    await vi.advanceTimersByTimeAsync(5000);
    expect(fake.frames.map(({ time }) => time)).toEqual([1, 2, 3]);
    expect(fake.frames.every(({ quality }) => quality.rays < REST.rays)).toBe(true);
  });

  it("they do again as soon as the connection is there, beginning with the last request", () => {
    const { fake, pictures, want } = opened();
    want(1, false);
    fake.listener?.onOpen(false);
    want(2, false);
    expect(fake.requests).toHaveLength(1);
    fake.listener?.onOpen(true);
    expect(fake.requests.map(({ time }) => time)).toEqual([1, 2]);
    expect(pictures.isFreeFor(3)).toBe(true);
  });
});

it("what a preview of keys that are still to be made lacks is no failure, and what a picture lacks is", () => {
  const { fake, document, want } = opened();
  const missing = errorOf(404, { code: "key_not_found", detail: "there is no key at 43" });
  want(5, true, UNSAVED);
  document.preview(UNSAVED);
  expect(() => fake.listener?.onError(missing)).not.toThrow();
  document.endPreview();
  expect(() => fake.listener?.onError(missing)).toThrow("no key at 43");
  document.preview(UNSAVED);
  expect(() => fake.listener?.onError(errorOf(422, { code: "bad_lens_setting", detail: "too small" }))).toThrow(
    "too small",
  );
});
