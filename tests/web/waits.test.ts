import { signal } from "@preact/signals";
import { Editor } from "@/editor/editor";
import { Session } from "@/editor/session";
import { Waits } from "@/editor/waits";
import { isAbort } from "@/net/errors";
import { FakeService, SHOT, turn } from "./fake_service";

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

/** Work that goes on until it is aborted, as far as it has come. */
function endless(abort: AbortSignal): Promise<never> {
  return new Promise((_, reject) => {
    abort.addEventListener("abort", () => {
      reject(new DOMException("Gone.", "AbortError"));
    });
  });
}

describe("a wait", () => {
  it("has its name, and how far it is, until it is over", async () => {
    const waits = new Waits();
    let finish = (): void => undefined;
    const done = waits.run("upload", "Sending a.zip", async (_, told) => {
      told.progress.value = 0.25;
      await new Promise<void>((resolve) => (finish = resolve));
      return 7;
    });
    expect(waits.of("upload")).toMatchObject({
      kind: "upload",
      name: { value: "Sending a.zip" },
      progress: { value: 0.25 },
    });
    expect(waits.of("download")).toBeNull();
    finish();
    expect(await done).toBe(7);
    expect(waits.of("upload")).toBeNull();
  });

  it("that is stopped ends at once, and its work is aborted", async () => {
    const waits = new Waits();
    let isAborted = false;
    const done = waits.run("download", "Making JSON", (abort) => {
      abort.addEventListener("abort", () => (isAborted = true));
      return new Promise(() => undefined); // that does not heed it
    });
    waits.of("download")?.stop?.();
    const error: unknown = await done.catch((reason: unknown) => reason);
    expect([isAbort(error), isAborted, waits.of("download")]).toEqual([true, true, null]);
  });

  it("of what has its own ways to begin follows it", () => {
    const waits = new Waits();
    const name = signal<string | null>(null);
    const end = waits.follow("picture", name);
    expect(waits.of("picture")).toBeNull();
    name.value = "Drawing frame 1";
    const first = waits.of("picture");
    name.value = "Drawing frame 2";
    expect([first?.name.value, waits.of("picture")?.name.value]).toEqual(["Drawing frame 1", "Drawing frame 2"]);
    end();
    expect(waits.of("picture")).toBeNull();
  });
});

describe("Escape", () => {
  it("stops the newest wait that a person has asked for", () => {
    const waits = new Waits();
    const stopped: string[] = [];
    const begin = (kind: "opening" | "download" | "meter"): void => {
      waits.begin(kind, kind, { stop: () => stopped.push(kind) });
    };
    for (const kind of ["opening", "download", "meter"] as const) begin(kind);
    expect([waits.stopNewest(), stopped]).toEqual([true, ["download"]]);
  });

  it("leaves alone what goes on by itself, or cannot be stopped", () => {
    const waits = new Waits();
    waits.begin("meter", "Metering", { stop: () => expect.fail() });
    waits.begin("opening", "Opening");
    expect(waits.stopNewest()).toBe(false);
  });
});

describe("a shot that is being opened", () => {
  it("and stopped is not opened, and nobody complains", async () => {
    const fake = new FakeService();
    const editor = new Editor(fake.service, () => undefined);
    await editor.start(null, null, null);
    const before = editor.session.value;
    fake.open = (_shot?: string, abort?: AbortSignal) => endless(abort ?? new AbortController().signal);
    void editor.open("demo", "/cam");
    expect(editor.waits.of("opening")?.name.value).toBe("Opening Demo");
    editor.waits.of("opening")?.stop?.();
    await turn();
    expect([editor.opening.value, editor.waits.of("opening"), editor.complaint.value]).toEqual([null, null, null]);
    expect(editor.session.value).toBe(before);
  });

  it("is given up where another one is chosen", async () => {
    const fake = new FakeService();
    const editor = new Editor(fake.service, () => undefined);
    const aborts: (AbortSignal | undefined)[] = [];
    fake.open = (_shot?: string, abort?: AbortSignal) => {
      aborts.push(abort);
      return endless(abort ?? new AbortController().signal);
    };
    void editor.open("one");
    void editor.open("two");
    await turn();
    expect([aborts.map((abort) => abort?.aborted), editor.waits.of("opening")?.name.value]).toEqual([
      [true, false],
      "Opening two",
    ]);
  });
});

it("a download that is stopped while an edit is saved is not made", async () => {
  const fake = new FakeService();
  const editor = new Editor(fake.service, () => undefined);
  await editor.start(null, null, null);
  let saved = (): void => undefined;
  fake.gate = () => new Promise((resolve) => (saved = resolve));
  void editor.session.value?.document.edit("a", [{ type: "removePoint", name: "a" }]);
  const make = vi.fn();
  const exported = editor.export("Edit layer", make, () => expect.fail());
  await turn();
  expect(editor.waits.of("edit")?.name.value).toBe("Saving: a");
  expect(editor.waits.stopNewest()).toBe(true);
  await exported;
  saved();
  await turn();
  expect([make.mock.calls.length, editor.complaint.value, editor.waits.of("edit")]).toEqual([0, null, null]);
});

/** A session whose picture is wanted. */
async function opened(): Promise<{ fake: FakeService; session: Session }> {
  const fake = new FakeService();
  const rights = { noEdits: signal(null), noPictures: signal(null) };
  const onFail = (error: unknown): void => {
    expect(isAbort(error)).toBe(true);
  };
  const session = new Session(fake.service, SHOT, "/cam", 1, onFail, rights);
  session.box.value = { width: 800, height: 400 };
  await turn();
  return { fake, session };
}

describe("an open shot", () => {
  it("waits for its exact picture, which is stopped and drawn after all", async () => {
    const { fake, session } = await opened();
    expect(session.waits.of("picture")?.name.value).toBe("Drawing frame 1");
    session.waits.of("picture")?.stop?.();
    expect([session.waits.of("picture"), session.pictures.stopped.value, fake.cancelled]).toEqual([null, true, 1]);
    session.pictures.resume();
    expect([session.pictures.stopped.value, fake.requests.length]).toEqual([false, 2]);
    session.close();
    expect(session.waits.of("picture")).toBeNull();
  });

  it("draws another frame though the one before was stopped", async () => {
    const { fake, session } = await opened();
    session.pictures.stop();
    session.playhead.goTo(9);
    expect([session.pictures.stopped.value, fake.requests.at(-1)?.time]).toEqual([false, 9]);
    session.close();
  });

  it("meters, which is stopped, and meters again", async () => {
    const { fake, session } = await opened();
    const aborts: (AbortSignal | undefined)[] = [];
    fake.service.meter = (_view, _time, _request, abort) => {
      aborts.push(abort);
      return endless(abort ?? new AbortController().signal);
    };
    session.meter();
    expect(session.waits.of("meter")?.name.value).toBe("Metering");
    session.waits.of("meter")?.stop?.();
    await turn();
    expect([aborts[0]?.aborted, session.waits.of("meter")]).toEqual([true, null]);
    session.meter();
    expect([aborts.length, session.waits.of("meter")?.name.value]).toEqual([2, "Metering"]);
    session.close();
    expect(session.waits.of("meter")).toBeNull();
  });
});

describe("what a person asks of an open shot", () => {
  it("caches its range until that is stopped", async () => {
    const { session } = await opened();
    session.filler.ask(true);
    expect(session.waits.of("frames")).toMatchObject({ name: { value: "Caching frames" }, progress: { value: 0 } });
    expect(session.waits.stopNewest()).toBe(true);
    expect([session.filler.asked.value, session.waits.of("frames")]).toEqual([false, null]);
    session.close();
  });

  it("lets go of a click whose place is still looked up", async () => {
    const { fake, session } = await opened();
    fake.service.pick = (_view, _time, _at, _quality, abort) => endless(abort ?? new AbortController().signal);
    void session.picks.click([0.5, 0.5], "pull");
    await turn();
    expect(session.waits.of("pick")?.name.value).toBe("Finding what is there");
    expect(session.waits.stopNewest()).toBe(true);
    await session.idle();
    expect([session.picks.picking.value, fake.made]).toEqual([null, []]);
    session.close();
  });
});
