import { Renders } from "@/editor/renders";
import { errorOf } from "@/net/errors";
import { LOOK_MS, PolledChanges, type RenderChanges } from "@/net/render_changes";
import { turn } from "./fake_service";
import { FakeRenders, render, task } from "./render_fixtures";

/** Changes that a test tells of. */
class ToldChanges implements RenderChanges {
  tell: () => void = () => undefined;
  isOn = false;

  start(onChange: () => void): void {
    [this.tell, this.isOn] = [onChange, true];
  }

  stop(): void {
    this.isOn = false;
  }
}

async function followed(...all: FakeRenders["all"]): Promise<{
  renders: Renders;
  service: FakeRenders;
  changes: ToldChanges;
  unfollow: () => void;
}> {
  const [service, changes] = [new FakeRenders(), new ToldChanges()];
  service.all = all;
  const renders = new Renders(service, changes);
  const unfollow = renders.follow();
  await turn();
  return { renders, service, changes, unfollow };
}

const numbered = (count: number): FakeRenders["all"] =>
  Array.from({ length: count }, (_, at) => render({ id: `r-${count - at}` }));

describe("the list of renders", () => {
  it("is read at once, and again when something changes, until it is left", async () => {
    const { renders, service, changes, unfollow } = await followed(render());
    expect(renders.all.value).toEqual([render()]);
    service.all = [render({ done: 1, ready: 3 })];
    changes.tell();
    await turn();
    expect(renders.all.value?.[0]?.done).toBe(1);
    unfollow();
    expect(changes.isOn).toBe(false);
  });

  it("is read once more, and not twice at a time, where it changes while it is read", async () => {
    const { service, changes } = await followed(render());
    let go: () => void = () => undefined;
    service.gate = () => new Promise((resolve) => (go = resolve));
    service.calls.length = 0;
    changes.tell();
    changes.tell();
    changes.tell();
    expect(service.calls).toEqual(["list 50 newest"]);
    go();
    await turn();
    service.gate = () => Promise.resolve();
    go();
    await turn();
    expect(service.calls).toEqual(["list 50 newest", "list 50 newest"]);
  });

  it("has older ones when they are wanted, page by page", async () => {
    const { renders, service } = await followed(...numbered(220));
    expect([renders.all.value?.length, renders.hasOlder.value]).toEqual([50, true]);
    for (let times = 0; times < 3; times += 1) await renders.showOlder();
    service.calls.length = 0;
    await renders.showOlder();
    expect(service.calls).toEqual(["list 200 newest", "list 50 r-21"]);
    expect([renders.all.value?.length, renders.hasOlder.value]).toEqual([220, false]);
  });

  it("says why it may be old, until it is read again", async () => {
    const { renders, service, changes } = await followed(render());
    service.failing = { list: errorOf(500, { code: "internal", detail: "It broke." }) };
    changes.tell();
    await turn();
    expect(renders.complaint.value).toMatch(/^It broke\./);
    expect(renders.all.value).toHaveLength(1);
    changes.tell();
    await turn();
    expect(renders.complaint.value).toBeNull();
  });
});

describe("an action", () => {
  it("shows its answer, which no older list undoes", async () => {
    const { renders, service, changes } = await followed(render());
    let go: () => void = () => undefined;
    service.gate = () => new Promise((resolve) => (go = resolve));
    changes.tell(); // reads the list as it was before the action
    service.gate = () => Promise.resolve();
    const states: (string | undefined)[] = [];
    const unsubscribe = renders.all.subscribe((all) => states.push(all?.[0]?.state));
    const acted = renders.act(render(), "pause");
    await turn();
    service.all = [render({ state: "canceled" })];
    go();
    await acted;
    unsubscribe();
    expect(states).toEqual(["queued", "paused", "canceled"]);
  });

  it("is sent once while it is under way", async () => {
    const { renders, service } = await followed(render());
    await Promise.all([renders.act(render(), "cancel"), renders.act(render(), "cancel")]);
    expect(service.calls.filter((call) => call.startsWith("cancel"))).toEqual(["cancel r-1"]);
    expect(renders.acting.value.size).toBe(0);
  });

  it("says why it was refused", async () => {
    const { renders, service } = await followed(render());
    service.failing = { act: errorOf(409, { code: "conflict", detail: "render 'r-1' has ended" }) };
    await renders.act(render(), "pause");
    expect(renders.refusal.value).toBe("Render 'r-1' has ended. Nothing was changed.");
    await renders.act(render(), "pause");
    expect(renders.refusal.value).toBeNull();
  });

  it("takes a removed render off the list, with its frames", async () => {
    const { renders } = await followed(render(), render({ id: "r-0" }));
    renders.open("r-1");
    await renders.act(render(), "remove");
    expect(renders.all.value?.map(({ id }) => id)).toEqual(["r-0"]);
    expect(renders.opened.value).toBeNull();
  });
});

describe("the frames of a render", () => {
  it("are read when it is opened, and again only where some changed", async () => {
    const { renders, service, changes } = await followed(render());
    service.ofRender = [task(1, "ready")];
    renders.open("r-1");
    await turn();
    expect(renders.tasks.value).toEqual([task(1, "ready")]);
    changes.tell();
    await turn();
    service.all = [render({ ready: 3, done: 1 })];
    service.ofRender = [task(1, "done")];
    changes.tell();
    await turn();
    expect(renders.tasks.value).toEqual([task(1, "done")]);
    expect(service.calls.filter((call) => call === "tasks r-1")).toHaveLength(2);
  });

  it("of one that was just sent are shown", async () => {
    const { renders, service } = await followed(render());
    const sent = render({ id: "r-2" });
    service.all = [sent, ...service.all];
    renders.add(sent);
    expect(renders.all.value?.map(({ id }) => id)).toEqual(["r-2", "r-1"]);
    expect([renders.takeAdded("r-1"), renders.takeAdded("r-2"), renders.takeAdded("r-2")]).toEqual([
      false,
      true,
      false,
    ]);
    await turn();
    expect([renders.opened.value, service.calls.at(-1)]).toEqual(["r-2", "tasks r-2"]);
  });
});

describe("changes that are looked for", () => {
  afterEach(() => {
    vi.useRealTimers();
  });

  it("are told every two seconds while the page is seen, at once when it is seen again, and not after the end", () => {
    vi.useFakeTimers();
    const page = Object.assign(new EventTarget(), { visibilityState: "visible" });
    const changes = new PolledChanges(page as unknown as Document);
    let told = 0;
    changes.start(() => (told += 1));
    vi.advanceTimersByTime(2 * LOOK_MS);
    expect(told).toBe(2);
    page.visibilityState = "hidden";
    vi.advanceTimersByTime(5 * LOOK_MS);
    expect(told).toBe(2);
    page.visibilityState = "visible";
    page.dispatchEvent(new Event("visibilitychange"));
    expect(told).toBe(3);
    changes.stop();
    vi.advanceTimersByTime(5 * LOOK_MS);
    page.dispatchEvent(new Event("visibilitychange"));
    expect(told).toBe(3);
  });
});
