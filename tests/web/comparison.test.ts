import { signal } from "@preact/signals";
import { Comparison, type Compared } from "@/editor/comparison";
import type { Displayed } from "@/editor/pictures";
import { changesOf, saidOtherwise, THIN } from "@/model/comparison";
import type { LensSummary } from "@/model/lens";
import type { LiveListener, LivePicture, PictureRequest } from "@/net/live_link";
import type { Service } from "@/net/service";
import type { View } from "@/net/view";

describe("what is otherwise", () => {
  it("is made by changes of the camera", () => {
    expect(changesOf({ camera: null, lens: null, fStop: null }, 3, false)).toEqual([]);
    expect(changesOf({ camera: "/b", lens: THIN, fStop: 8 }, 3, true)).toEqual([
      { type: "setCamera", values: { lens: null } },
      { type: "setFocus", values: { solveStop: false } },
      { type: "setCamera", values: { fStop: 8, time: 3 } },
    ]);
  });

  it("is said in words", () => {
    const lenses = [{ name: "biotar_58", title: "Biotar 58 mm f/1.4" }] as unknown as readonly LensSummary[];
    expect(saidOtherwise({ camera: "/World/b", lens: "biotar_58", fStop: 5.6 }, lenses)).toBe(
      "b, Biotar 58 mm f/1.4, f/5.6",
    );
    expect(saidOtherwise({ camera: null, lens: THIN, fStop: null }, lenses)).toBe("thin lens");
    expect(saidOtherwise({ camera: null, lens: null, fStop: null }, lenses)).toBe("the same");
  });
});

/** A session and a service, and what they were asked for. */
function made(): {
  comparison: Comparison;
  settled: { value: boolean };
  asked: { view: View; request: PictureRequest }[];
  listeners: LiveListener[];
  closed: { count: number };
} {
  vi.stubGlobal("createImageBitmap", () => Promise.resolve({ close: () => undefined }));
  const [settled, asked, listeners, closed] = [signal(false), [] as never[], [] as LiveListener[], { count: 0 }];
  const requests: { view: View; request: PictureRequest }[] = asked;
  const service = {
    live: (view: View, listener: LiveListener) => {
      listeners.push(listener);
      return {
        free: true,
        request: (request: PictureRequest) => requests.push({ view, request }),
        cancel: () => undefined,
        close: () => (closed.count += 1),
      };
    },
  } as unknown as Service;
  const session = {
    document: { view: { shot: "demo", camera: "/a" }, revision: signal(0) },
    playhead: { time: signal(5) },
    pictures: { displayed: signal<Displayed | null>({ bitmap: {} } as Displayed), refusal: null },
    settled,
    motion: signal(1),
    box: signal({ width: 320, height: 180 }),
    pointsSetStop: signal(false),
  } as unknown as Compared;
  const comparison = new Comparison(service, session, (error) => {
    throw error;
  });
  return { comparison, settled, asked: requests, listeners, closed };
}

const FINAL = { blob: new Blob(), stage: "final" } as LivePicture;

describe("a comparison", () => {
  it("draws what is otherwise once the best picture is there, and tells when it is whole", async () => {
    const { comparison, settled, asked, listeners, closed } = made();
    comparison.otherwise.value = { camera: "/b", lens: null, fStop: 4 };
    comparison.toggle("wipe");
    expect(asked).toHaveLength(0);
    settled.value = true;
    expect(asked.map(({ view }) => view)).toEqual([{ shot: "demo", camera: "/b" }]);
    expect(asked[0]?.request).toMatchObject({ time: 5, moving: false, unsaved: [{ values: { fStop: 4, time: 5 } }] });
    await listeners[0]?.onPicture({ ...FINAL, stage: "preview" }, {} as PictureRequest);
    expect(comparison.isBest.value).toBe(false);
    await listeners[0]?.onPicture(FINAL, {} as PictureRequest);
    expect(comparison.other.value).not.toBeNull();
    expect(comparison.isBest.value).toBe(true);
    comparison.otherwise.value = { camera: null, lens: null, fStop: 4 };
    expect(asked.map(({ view }) => view.camera)).toEqual(["/b", "/a"]);
    comparison.toggle("wipe");
    expect(closed.count).toBe(2);
    expect(comparison.other.value).toBeNull();
  });

  it("keeps snapshots, the newest first, and drops the oldest", async () => {
    const { comparison, asked, settled } = made();
    settled.value = true;
    for (let number = 1; number <= 9; number++) await comparison.take(`frame ${number}`);
    expect(comparison.snapshots.value.map(({ said }) => said).at(-1)).toBe("frame 2");
    expect(comparison.snapshot.value?.said).toBe("frame 9");
    comparison.swap();
    expect(comparison.mode.value).toBe("other");
    expect(asked).toHaveLength(0);
    const newest = comparison.snapshot.value;
    if (newest) comparison.drop(newest);
    expect(comparison.snapshot.value?.said).toBe("frame 8");
    comparison.toggle("flicker");
    comparison.swap();
    expect(comparison.showsOther.value).toBe(true);
    comparison.close();
  });
});
