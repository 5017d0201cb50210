import { signal } from "@preact/signals";
import { Playhead } from "@/editor/playhead";

const RANGE = { start: 1, end: 96, framesPerSecond: 24 };

/** A playhead whose animation frames a test makes, each so many ms after the one before. */
function playing(isFree: (time: number) => boolean = () => true): {
  playhead: Playhead;
  tick: (ms: number) => void;
} {
  let [now, callback]: [number, FrameRequestCallback | null] = [0, null];
  vi.stubGlobal("requestAnimationFrame", (next: FrameRequestCallback) => {
    callback = next;
    return 1;
  });
  vi.stubGlobal("cancelAnimationFrame", () => (callback = null));
  vi.stubGlobal("performance", { now: () => now });
  const tick = (ms: number): void => {
    now += ms;
    const due = callback;
    callback = null;
    due?.(now);
  };
  return { playhead: new Playhead(RANGE, 1, isFree), tick };
}

afterEach(() => {
  vi.unstubAllGlobals();
});

const FRAME_MS = 1000 / 24 + 0.01;

describe("playing", () => {
  it("keeps to what is marked, and begins within it", () => {
    const { playhead, tick } = playing();
    playhead.markFirst(10);
    playhead.markLast(12);
    playhead.play();
    const times: number[] = [];
    for (let k = 0; k < 5; k += 1) {
      tick(FRAME_MS);
      times.push(playhead.time.value);
    }
    expect(times).toEqual([10, 11, 12, 10, 11]);
  });

  it("once ends on the last frame, and then begins anew", () => {
    const { playhead, tick } = playing();
    playhead.setRepeat("once");
    playhead.markLast(3);
    playhead.play();
    for (let k = 0; k < 5; k += 1) tick(FRAME_MS);
    expect([playhead.playing.value, playhead.time.value]).toEqual([false, 3]);
    playhead.play();
    tick(FRAME_MS);
    expect([playhead.playing.value, playhead.time.value]).toEqual([true, 1]);
  });

  it("goes on with what is changed under way", () => {
    const { playhead, tick } = playing();
    playhead.play();
    tick(FRAME_MS);
    playhead.shuttle(1);
    expect(playhead.speed.value).toBe(2);
    playhead.shuttle(-1);
    expect(playhead.speed.value).toBe(-1);
    playhead.setEvery(2);
    expect([playhead.playing.value, playhead.speed.value]).toEqual([true, -1]);
    const rests: boolean[] = [];
    playhead.playing.subscribe((is) => void rests.push(is));
    playhead.shuttle(-1);
    expect(rests).toEqual([true]);
    playhead.pause();
    playhead.setEvery(1);
    expect(playhead.playing.value).toBe(false);
  });
});

describe("what was seen", () => {
  it("lacks frames whose picture is not there in time", () => {
    const shown = signal<{ time: number } | null>({ time: 1 });
    const { playhead, tick } = playing((time) => time !== 3);
    playhead.watch(shown);
    playhead.play();
    for (let k = 0; k < 4; k += 1) {
      tick(FRAME_MS);
      if (shown.value?.time !== playhead.time.value) shown.value = { time: playhead.time.value };
    }
    expect(playhead.time.value).toBe(4);
    expect(playhead.seen.value.dropped).toBe(1);
  });

  it("is all, where all pictures are there", () => {
    const shown = signal<{ time: number } | null>({ time: 1 });
    const { playhead, tick } = playing();
    playhead.watch(shown);
    playhead.markLast(4);
    playhead.play();
    for (let k = 0; k < 24; k += 1) {
      tick(FRAME_MS);
      if (shown.value?.time !== playhead.time.value) shown.value = { time: playhead.time.value };
    }
    expect(playhead.seen.value.dropped).toBe(0);
    expect(playhead.seen.value.rate).toBeCloseTo(24, 1);
  });
});

describe("marks", () => {
  it("that lie the wrong way round give way to the newer one", () => {
    const { playhead } = playing();
    playhead.markFirst(20);
    playhead.markLast(10);
    expect([playhead.first.value, playhead.last.value]).toEqual([null, 10]);
    playhead.markFirst(50);
    expect(playhead.played.value).toMatchObject({ start: 50, end: 96 });
    playhead.markFirst(null);
    expect(playhead.played.value).toMatchObject({ start: 1, end: 96 });
  });
});
