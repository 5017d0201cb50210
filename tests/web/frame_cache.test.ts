import { computed, signal, type Signal } from "@preact/signals";
import { CacheFiller } from "@/editor/cache_filler";
import { ShotDocument } from "@/editor/document";
import { FrameCache } from "@/editor/frame_cache";
import type { Displayed } from "@/editor/pictures";
import { Playhead } from "@/editor/playhead";
import { errorOf } from "@/net/errors";
import type { LivePicture } from "@/net/live_link";
import { FakeService, FOCUS_MAP, SHOT } from "./fake_service";

const RANGE = { first: 10, last: 14 };

beforeEach(() => {
  vi.useFakeTimers();
});

afterEach(() => {
  vi.useRealTimers();
});

interface Stand {
  readonly fake: FakeService;
  readonly document: ShotDocument;
  readonly cache: FrameCache;
  readonly filler: CacheFiller;
  readonly playhead: Playhead;
  readonly settled: Signal<boolean>;
  readonly focusMaps: Signal<boolean>;
  readonly failures: unknown[];
  /** Lets all that is under way happen. */
  run: (ms?: number) => Promise<void>;
  /** Times of the frames that were asked for. */
  made: () => number[];
}

function stand(tookMs = 60_000, mostBytes?: number): Stand {
  const [fake, failures] = [new FakeService(), [] as unknown[]];
  const fail = (error: unknown): void => void failures.push(error);
  const playhead = new Playhead(SHOT.range, 12, () => true);
  playhead.markFirst(RANGE.first);
  playhead.markLast(RANGE.last);
  const document = new ShotDocument(fake.service, SHOT, "/cam", playhead.time, fail);
  const cache = new FrameCache(fake.service, document, playhead.time, mostBytes);
  const settled = signal(true);
  const focusMaps = signal(false);
  const displayed = signal({ width: 960, height: 480, tookMs } as Displayed);
  const player = {
    document,
    cache,
    playhead,
    pictures: { displayed },
    settled: computed(() => settled.value),
    focusMaps,
    aspect: 2,
  };
  const filler = new CacheFiller(fake.service, player, fail);
  const run = async (ms = 0): Promise<void> => {
    await vi.advanceTimersByTimeAsync(ms);
  };
  return {
    fake,
    document,
    cache,
    filler,
    playhead,
    settled,
    focusMaps,
    failures,
    run,
    made: () => fake.cacheRequests.map(({ time }) => time),
  };
}

function pictureOf(bytes: number): LivePicture {
  const facts = { width: 4, height: 2, rays: 0, share: 0, tookMs: 1, focusMap: null };
  return { blob: new Blob(["x".repeat(bytes)]), stage: "preview", ...facts };
}

const STEP = { type: "removePoint", name: "hero" } as const;

describe("frames for playing", () => {
  it("get focus maps where pictures come with them, and are not made again", async () => {
    const { cache, fake, focusMaps, made, run } = stand();
    await run(2500);
    expect(made()).toHaveLength(5);
    expect(cache.mappedTimes.value).toEqual([]);
    const before = cache.bytes.value;
    focusMaps.value = true;
    await run(2500);
    expect(cache.mappedTimes.value.toSorted()).toEqual([10, 11, 12, 13, 14]);
    expect(cache.find(12)?.focusMap).toBe(FOCUS_MAP);
    expect(cache.bytes.value).toBe(before + 5 * FOCUS_MAP.byteLength);
    expect(made()).toHaveLength(5);
    expect(fake.mapRequests).toHaveLength(5);
  });

  it("are made while nothing else is wanted, those near the playhead first", async () => {
    const { cache, made, run } = stand();
    await run(2000);
    expect(made()).toEqual([]);
    await run(1000);
    expect(made()).toEqual([12, 13, 11, 14, 10]);
    expect([...cache.times.value].sort()).toEqual([10, 11, 12, 13, 14]);
  });

  it("are made at once where they are asked for, until all are there", async () => {
    const { filler, made, run } = stand();
    filler.ask(true);
    await run();
    expect(made()).toHaveLength(5);
    expect(filler.asked.value).toBe(false);
    expect(filler.progress.value).toEqual({ cached: 5, of: 5, missing: 0 });
  });

  it("wait as soon as something else is wanted, and what was under way is made again", async () => {
    const { fake, filler, settled, made, run } = stand();
    fake.cacheGate = () => new Promise((resolve) => setTimeout(resolve, 100));
    filler.ask(true);
    await run(150);
    settled.value = false;
    await run(1000);
    expect(made()).toEqual([12, 13]);
    settled.value = true;
    await run(1000);
    expect(made()).toEqual([12, 13, 13, 11, 14, 10]);
  });
});

describe("the frames that are made", () => {
  it("are those of every n-th frame where no other is played", async () => {
    const { filler, playhead, made, run } = stand();
    playhead.setEvery(2);
    filler.ask(true);
    await run();
    expect(made()).toEqual([12, 14, 10]);
  });

  it.each([
    [1500, "lens"],
    [60_000, "flag"],
  ] as const)("come from the engine that fits: where an exact picture takes %s ms, %s", async (tookMs, engine) => {
    const { fake, filler, run } = stand(tookMs / 2);
    filler.ask(true);
    await run();
    expect(new Set(fake.cacheRequests.map((request) => request.engine))).toEqual(new Set([engine]));
  });

  it("that cannot be made are not asked for", async () => {
    const { fake, filler, made, run } = stand();
    fake.stateAt = (time) => (time === 13 ? null : "as shot");
    filler.ask(true);
    await run();
    expect(made()).not.toContain(13);
    expect(filler.progress.value).toEqual({ cached: 4, of: 5, missing: 0 });
  });
});

describe("an edit", () => {
  it("leaves the frames whose answer it does not change", async () => {
    const { fake, document, cache, filler, made, run } = stand();
    filler.ask(true);
    await run();
    const read = fake.pictureStates.bind(fake);
    fake.pictureStates = async (...part) => {
      await new Promise((resolve) => setTimeout(resolve, 10));
      return read(...part);
    };
    fake.stateAt = (time) => (time > 12 ? "bent" : "as shot");
    await document.edit("bend", [STEP]);
    expect(cache.find(11)).toBeNull(); // it is not known yet
    await run(10);
    expect([...cache.times.value].sort()).toEqual([10, 11, 12]);
    expect(cache.find(13)).toBeNull();
    await run(3000);
    expect(made().slice(5)).toEqual([13, 14]);
  });

  it("drops a frame that was being made before it", async () => {
    const { fake, document, cache, filler, settled, run } = stand();
    fake.cacheGate = () => new Promise((resolve) => setTimeout(resolve, 100));
    filler.ask(true);
    await run(50);
    settled.value = false;
    await document.edit("bend", [STEP]);
    await run(500);
    expect(cache.times.value).toEqual([]);
  });

  it("allows what failed before it", async () => {
    const { fake, document, filler, made, run, failures } = stand();
    fake.cacheGate = () => Promise.reject(errorOf(500, { code: "broken", detail: "no" }));
    await run(20_000);
    expect(made()).toEqual([12, 13, 11]); // unasked, it tries three
    expect(failures).toEqual([]);
    filler.ask(true);
    await run();
    expect(failures).toHaveLength(1);
    expect(filler.asked.value).toBe(false);
    fake.cacheGate = () => Promise.resolve();
    await document.edit("bend", [STEP]);
    await run(3000);
    expect(filler.progress.value.missing).toBe(0);
  });
});

describe("a frame", () => {
  it("that cannot be made does not keep the others back", async () => {
    const { fake, filler, cache, failures, run } = stand();
    fake.cacheGate = (time) =>
      time === 12 ? Promise.reject(errorOf(422, { code: "costly", detail: "no" })) : Promise.resolve();
    filler.ask(true);
    await run();
    expect([...cache.times.value].sort()).toEqual([10, 11, 13, 14]);
    expect([failures.length, filler.asked.value]).toEqual([1, false]);
  });

  it("of edits that are not known here is not kept, and they are read", async () => {
    const { fake, document, cache, filler, run } = stand();
    fake.pictureRevision = () => "of somebody else";
    const catchUp = vi.spyOn(document, "catchUp").mockResolvedValue(true);
    filler.ask(true);
    await run();
    filler.ask(false);
    await run();
    expect(cache.times.value).toEqual([]);
    expect(catchUp).toHaveBeenCalled();
  });
});

describe("the memory", () => {
  async function ready(mostBytes: number): Promise<Stand> {
    const made = stand(60_000, mostBytes);
    made.cache.isFilling.value = true;
    await made.run();
    return made;
  }

  it("holds frames near the playhead, and forgets those that are farther", async () => {
    const { cache } = await ready(250);
    for (const time of [10, 20]) expect(cache.put(time, pictureOf(100), "now", 12)).toBe("kept");
    expect(cache.put(14, pictureOf(100), "now", 12)).toBe("kept");
    expect([...cache.times.value].sort()).toEqual([10, 14]);
    expect(cache.put(30, pictureOf(100), "now", 12)).toBe("full");
    expect(cache.bytes.value).toBe(200);
  });

  it("is never exceeded, and a frame in place of another counts once", async () => {
    const { cache } = await ready(250);
    for (const time of [10, 11, 10, 11]) cache.put(time, pictureOf(120), "now", 10);
    expect(cache.bytes.value).toBe(240);
    expect(cache.put(12, pictureOf(1000), "now", 12)).toBe("full");
    expect(cache.bytes.value).toBeLessThanOrEqual(250);
    cache.clear();
    expect(cache.bytes.value).toBe(0);
  });

  it("that is full is said, and nothing more is made", async () => {
    const { filler, made, run } = stand(60_000, 30); // "cached 12" are nine bytes
    filler.ask(true);
    await run();
    expect(filler.isFull.value).toBe(true);
    const before = made().length;
    await run(20_000);
    expect(made()).toHaveLength(before);
  });
});
