import { NewestWins } from "@/net/newest";

/** A loader whose answers come when the test says so. */
function harness(mostInFlight = 2): {
  loaded: string[];
  aborted: string[];
  shown: string[];
  failed: string[];
  fetcher: NewestWins<string, string>;
  answer: (name: string) => Promise<void>;
  refuse: (name: string) => Promise<void>;
} {
  const loaded: string[] = [];
  const aborted: string[] = [];
  const shown: string[] = [];
  const failed: string[] = [];
  const open = new Map<string, { resolve: (name: string) => void; reject: (error: Error) => void }>();
  const settle = async (): Promise<void> => {
    await new Promise((resolve) => setTimeout(resolve));
  };
  const fetcher = new NewestWins<string, string>({
    load: (name, signal) => {
      loaded.push(name);
      signal.addEventListener("abort", () => aborted.push(name));
      return new Promise((resolve, reject) => open.set(name, { resolve, reject }));
    },
    onResult: (result) => shown.push(result),
    onError: (_, request) => failed.push(request),
    mostInFlight,
  });
  return {
    loaded,
    aborted,
    shown,
    failed,
    fetcher,
    answer: async (name) => {
      open.get(name)?.resolve(name);
      await settle();
    },
    refuse: async (name) => {
      open.get(name)?.reject(new Error(name));
      await settle();
    },
  };
}

describe("newest wins", () => {
  it("at most two are in flight, and of those that wait only the newest goes out", async () => {
    const { fetcher, loaded, shown, answer } = harness();
    for (const request of ["1", "2", "3", "4", "5"]) fetcher.load(request);
    expect(loaded).toEqual(["1", "2"]);
    await answer("1");
    expect(loaded).toEqual(["1", "2", "5"]);
    await answer("2");
    await answer("5");
    expect(shown).toEqual(["1", "2", "5"]);
    expect(fetcher.free).toBe(true);
  });

  it("never goes back: an older answer that comes late is dropped and its request given up", async () => {
    const { fetcher, shown, aborted, answer } = harness();
    fetcher.load("1");
    fetcher.load("2");
    await answer("2");
    expect(aborted).toEqual(["1"]);
    await answer("1");
    expect(shown).toEqual(["2"]);
  });

  it("what is disposable makes room at once for anything newer", () => {
    const { fetcher, loaded, aborted } = harness(1);
    fetcher.load("best", { disposable: true });
    fetcher.load("draft");
    expect(aborted).toEqual(["best"]);
    expect(loaded).toEqual(["best", "draft"]);
  });

  it("a failure is reported and does not stop later requests", async () => {
    const { fetcher, shown, failed, answer, refuse } = harness(1);
    fetcher.load("1");
    fetcher.load("2");
    await refuse("1");
    await answer("2");
    expect(failed).toEqual(["1"]);
    expect(shown).toEqual(["2"]);
  });

  it("cleared, nothing that was loaded for comes any more", async () => {
    const { fetcher, shown, failed, aborted, answer } = harness(1);
    fetcher.load("1");
    fetcher.load("2");
    fetcher.clear();
    await answer("1");
    expect([shown, failed, aborted]).toEqual([[], [], ["1"]]);
    expect(fetcher.free).toBe(true);
  });
});

it("what is given up during a pause is not sent", async () => {
  const loaded: string[] = [];
  let resume = (): void => undefined;
  const newest = new NewestWins<string, string>({
    load: (request) => {
      loaded.push(request);
      return Promise.resolve(request);
    },
    onResult: () => undefined,
    onError: () => undefined,
    pause: () => new Promise((resolve) => (resume = resolve)),
  });
  newest.load("1");
  newest.clear();
  resume();
  await new Promise((resolve) => setTimeout(resolve));
  expect(loaded).toEqual([]);
  newest.load("2");
  resume();
  await new Promise((resolve) => setTimeout(resolve));
  expect(loaded).toEqual(["2"]);
});
