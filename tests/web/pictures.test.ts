import { signal } from "@preact/signals";
import { ShotDocument } from "@/editor/document";
import { Pictures } from "@/editor/pictures";
import { restQuality } from "@/model/quality";
import { FakeService, SHOT } from "./fake_service";

const REST = restQuality(800, 400);

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("createImageBitmap", () => Promise.resolve({ close: () => undefined }));
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

function opened(): { fake: FakeService; pictures: Pictures; show: (time: number, moving: boolean) => Promise<void> } {
  const fake = new FakeService();
  const document = new ShotDocument(fake.service, SHOT, "/cam", signal(1), fail);
  const pictures = new Pictures(fake.service, document, fail);
  const show = async (time: number, moving: boolean): Promise<void> => {
    pictures.want({ time, revision: document.revision.value, quality: REST }, moving);
    await vi.advanceTimersByTimeAsync(200);
  };
  return { fake, pictures, show };
}

function fail(error: unknown): void {
  throw error;
}

describe("pictures", () => {
  it("at rest a quick one comes first, and the best when all has been still", async () => {
    const { fake, pictures, show } = opened();
    await show(5, false);
    expect(pictures.displayed.value).toMatchObject({ time: 5, best: false });
    await vi.advanceTimersByTimeAsync(2000);
    expect(pictures.displayed.value).toMatchObject({ time: 5, best: true, quality: REST });
    expect(fake.frames.map(({ quality }) => quality.width < REST.width)).toEqual([true, false]);
  });

  it("while things move the best one is never asked for", async () => {
    const { fake, show } = opened();
    for (const time of [1, 2, 3]) await show(time, true);
    await vi.advanceTimersByTimeAsync(5000);
    expect(fake.frames).toHaveLength(3);
    expect(fake.frames.every(({ quality }) => quality.rays < REST.rays)).toBe(true);
  });

  it("what was shown once is shown again without asking", async () => {
    const { fake, pictures, show } = opened();
    for (const time of [1, 2, 1, 2]) await show(time, true);
    expect(fake.frames.map(({ time }) => time)).toEqual([1, 2]);
    expect(pictures.displayed.value?.time).toBe(2);
    expect(pictures.keptTimes.value.toSorted()).toEqual([1, 2]);
  });
});
