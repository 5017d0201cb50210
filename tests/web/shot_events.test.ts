import { ShotEvents, shotEventsAddress } from "@/net/shot_events";

class FakeSocket {
  onopen: (() => void) | null = null;
  onclose: (() => void) | null = null;
  onmessage: ((event: { data: string }) => void) | null = null;
  readonly close = vi.fn();

  tell(message: unknown): void {
    this.onmessage?.({ data: JSON.stringify(message) });
  }
}

const sockets: FakeSocket[] = [];
const onEdits = vi.fn();
const admitted = vi.fn(() => Promise.resolve());

function connected(): [ShotEvents, FakeSocket] {
  const connect = (): never => {
    const socket = new FakeSocket();
    sockets.push(socket);
    return socket as never;
  };
  const events = new ShotEvents("ws://service", { onEdits }, { admitted, connect });
  const socket = sockets.at(-1);
  if (!socket) throw new Error("nothing was connected");
  return [events, socket];
}

beforeEach(() => {
  vi.useFakeTimers();
  vi.clearAllMocks();
  sockets.length = 0;
});
afterEach(() => vi.useRealTimers());

describe("events of a shot's edits", () => {
  it("tell revisions, and that some may have been missed", () => {
    const [, socket] = connected();
    socket.onopen?.();
    expect(onEdits).toHaveBeenLastCalledWith(null);
    socket.tell({ number: 3, topic: "edits", data: { revision: "r2" } });
    expect(onEdits).toHaveBeenLastCalledWith("r2");
    socket.tell({ after: 2, oldest: 9 });
    expect(onEdits).toHaveBeenLastCalledWith(null);
    expect(onEdits).toHaveBeenCalledTimes(3);
    socket.tell({ number: 4, topic: "shots", data: {} });
    expect(onEdits).toHaveBeenCalledTimes(3);
  });

  it("come again after a lost connection, and have the page look at each try", async () => {
    const [, socket] = connected();
    socket.onclose?.();
    await vi.advanceTimersByTimeAsync(500);
    expect(sockets.length).toBe(2);
    expect(onEdits).toHaveBeenCalledTimes(1);
    admitted.mockRejectedValueOnce(new Error("away"));
    sockets[1]?.onclose?.();
    await vi.advanceTimersByTimeAsync(1000);
    expect(sockets.length).toBe(2);
    expect(onEdits).toHaveBeenCalledTimes(1);
    await vi.advanceTimersByTimeAsync(2000);
    expect(sockets.length).toBe(3);
  });

  it("end with the link", async () => {
    const [events, socket] = connected();
    events.close();
    expect(socket.close).toHaveBeenCalled();
    socket.tell({ number: 3, topic: "edits", data: { revision: "r2" } });
    socket.onclose?.();
    await vi.advanceTimersByTimeAsync(60_000);
    expect(onEdits).not.toHaveBeenCalled();
    expect(sockets.length).toBe(1);
  });

  it("are asked for by the shot", () => {
    expect(shotEventsAddress("https://host", "a b&c")).toBe("wss://host/v1/events?topic=edits&shot=a%20b%26c");
  });
});
