import { TOLD_MS, ToldChanges, type RenderChanges } from "@/net/render_changes";

class FakeSource extends EventTarget {
  readyState = 1;
  readonly close = vi.fn();

  tell(topic: string): void {
    this.dispatchEvent(new Event(topic));
  }
}

class FakePolling implements RenderChanges {
  readonly start = vi.fn();
  readonly stop = vi.fn();
}

const sources: FakeSource[] = [];
const polling = new FakePolling();
const onChange = vi.fn();
const changes = new ToldChanges(() => {
  const source = new FakeSource();
  sources.push(source);
  return source as unknown as EventSource;
}, polling);

function started(): FakeSource {
  changes.start(onChange);
  const source = sources.at(-1);
  if (!source) throw new Error("nothing was connected");
  return source;
}

beforeEach(() => {
  vi.useFakeTimers();
  vi.clearAllMocks();
});
afterEach(() => {
  changes.stop();
  vi.useRealTimers();
});

describe("changes that the service tells", () => {
  it("are told for renders, frames, gaps and each connection, and for nothing else", () => {
    const source = started();
    for (const topic of ["open", "renders", "tasks", "gap", "shots"]) {
      source.tell(topic);
      vi.advanceTimersByTime(TOLD_MS);
    }
    expect(onChange).toHaveBeenCalledTimes(4);
  });

  it("are told at once, and then no more often than a list is read", () => {
    const source = started();
    for (let count = 0; count < 9; count++) source.tell("tasks");
    expect(onChange).toHaveBeenCalledTimes(1);
    vi.advanceTimersByTime(TOLD_MS);
    expect(onChange).toHaveBeenCalledTimes(2);
    vi.advanceTimersByTime(9 * TOLD_MS);
    expect(onChange).toHaveBeenCalledTimes(2);
  });
});

describe("a source of changes", () => {
  it("is replaced by looks where the service takes no more readers", () => {
    const source = started();
    source.tell("error"); // the browser connects again by itself
    expect(polling.start).not.toHaveBeenCalled();
    source.readyState = 2;
    source.tell("error");
    expect(polling.start).toHaveBeenCalledWith(onChange);
    source.tell("tasks");
    expect(onChange).not.toHaveBeenCalled();
  });

  it("tells nothing after a stop", () => {
    const source = started();
    source.tell("tasks");
    source.tell("tasks");
    changes.stop();
    expect(source.close).toHaveBeenCalled();
    source.tell("tasks");
    vi.advanceTimersByTime(9 * TOLD_MS);
    expect(onChange).toHaveBeenCalledTimes(1);
  });
});
