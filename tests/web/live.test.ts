import { restQuality } from "@/model/quality";
import type { Changes } from "@/model/changes";
import { LiveSocket, liveAddress, type Socket } from "@/net/live";
import { errorOf, UnreachableError } from "@/net/errors";
import type { Other } from "@/model/viewers";
import type { LivePicture, PictureRequest } from "@/net/live_link";

const QUALITY = restQuality(800, 400);

/** The service's end of a connection. */
class FakeSocket implements Socket {
  binaryType: BinaryType = "blob";
  onopen: Socket["onopen"] = null;
  onclose: Socket["onclose"] = null;
  onmessage: Socket["onmessage"] = null;
  readonly sent: Record<string, unknown>[] = [];
  closed = false;

  send(text: unknown): void {
    this.sent.push(JSON.parse(String(text)) as Record<string, unknown>);
  }

  close(): void {
    this.closed = true;
  }

  open(): void {
    this.onopen?.call(this as unknown as WebSocket, new Event("open"));
  }

  lose(code = 1006): void {
    this.onclose?.call(this as unknown as WebSocket, { code } as CloseEvent);
  }

  say(data: unknown): void {
    this.onmessage?.call(this as unknown as WebSocket, { data } as MessageEvent);
  }

  picture(id: number, picture: number, data = "pixels", focusMapBytes = 0): void {
    const timing = { rays: 6, share: 0.5, answeredMs: 80 };
    const facts = { stage: "preview", final: false, format: "jpeg", width: 200, height: 100, focusMapBytes, timing };
    const head = { id, picture, ...facts };
    const said = new TextEncoder().encode(JSON.stringify(head));
    const message = new Uint8Array([
      0,
      0,
      said.length >> 8,
      said.length & 255,
      ...said,
      ...new TextEncoder().encode(data),
    ]);
    this.say(message.buffer);
  }
}

interface Heard {
  readonly sockets: FakeSocket[];
  readonly live: LiveSocket;
  readonly pictures: { readonly picture: LivePicture; readonly time: number; readonly looked: () => void }[];
  readonly said: unknown[];
  readonly states: boolean[];
  readonly company: unknown[];
}

function connected(admitted: () => Promise<unknown> = () => Promise.resolve()): Heard & { socket: FakeSocket } {
  const [sockets, pictures, said, states]: [FakeSocket[], Heard["pictures"], unknown[], boolean[]] = [[], [], [], []];
  const company: unknown[] = [];
  const listener = {
    onPicture: (picture: LivePicture, { time }: PictureRequest): Promise<void> =>
      new Promise((looked) => pictures.push({ picture, time, looked })),
    onReadout: (readout: unknown): void => void said.push(readout),
    onError: (error: unknown): void => void said.push(error),
    onOpen: (isOpen: boolean): void => void states.push(isOpen),
    onOthers: (others: readonly Other[]): void => void company.push(others.map(({ label, time }) => [label, time])),
  };
  const connect = (): FakeSocket => {
    const socket = new FakeSocket();
    sockets.push(socket);
    return socket;
  };
  const live = new LiveSocket("ws://here", { shot: "demo", camera: "/cam" }, listener, { connect, admitted });
  const [socket] = sockets;
  if (!socket) throw new Error("It does not connect.");
  return { sockets, live, pictures, said, states, company, socket };
}

function request(time: number, unsaved: Changes = [], moving = true): PictureRequest {
  return { time, quality: QUALITY, unsaved, moving, focusMaps: false };
}

beforeEach(() => {
  vi.useFakeTimers();
});

afterEach(() => {
  vi.useRealTimers();
});

describe("a live connection", () => {
  it("asks at once, and of what was wanted before it was there for the newest alone", () => {
    const { live, socket } = connected();
    live.request(request(1));
    live.request(request(2));
    expect(socket.sent).toEqual([]);
    socket.open();
    live.request(request(3));
    expect(socket.sent.map(({ id, time }) => [id, time])).toEqual([
      [2, 2],
      [3, 3],
    ]);
    expect(socket.sent[0]).toMatchObject({ camera: "/cam", width: 800, height: 400, rays: 100, moving: true });
    expect(socket.binaryType).toBe("arraybuffer");
  });
  it("is free while at most two requests are without an answer; a newer one's answer stands for those before it", () => {
    const { live, socket } = connected();
    socket.open();
    const free = [1, 2, 3].map((time) => {
      live.request(request(time));
      return live.free;
    });
    expect(free).toEqual([true, false, false]);
    socket.picture(3, 1);
    expect(live.free).toBe(true);
  });

  it("sends what is unsaved as the changes that an edit takes", () => {
    const { live, socket } = connected();
    socket.open();
    const unsaved: Changes = [
      { type: "setCamera", values: { focusDistanceM: 0, time: 3 } },
      { type: "movePoint", name: "side", place: [0.1, 0.2], time: 3 },
    ];
    live.request(request(1, unsaved));
    expect(socket.sent[0]?.changes).toEqual(unsaved);
  });
});

describe("a live picture", () => {
  it("is acknowledged when it was looked at, and not before", async () => {
    const { live, socket, pictures } = connected();
    socket.open();
    live.request(request(1));
    socket.picture(1, 1);
    await vi.advanceTimersByTimeAsync(0);
    expect(socket.sent).toHaveLength(1);
    const [shown] = pictures;
    expect(shown).toMatchObject({
      time: 1,
      picture: { stage: "preview", width: 200, rays: 6, share: 0.5, tookMs: 80 },
    });
    expect(await shown?.picture.blob.text()).toBe("pixels");
    shown?.looked();
    await vi.advanceTimersByTimeAsync(0);
    expect(socket.sent.at(-1)).toEqual({ ack: 1 });
  });

  it("ends where its focus map begins", async () => {
    const { live, socket, pictures } = connected();
    socket.open();
    live.request(request(1));
    socket.picture(1, 1, "pixelsmap", 3);
    live.request(request(2));
    socket.picture(2, 2);
    await vi.advanceTimersByTimeAsync(0);
    expect(await pictures[0]?.picture.blob.text()).toBe("pixels");
    expect(new TextDecoder().decode(pictures[0]?.picture.focusMap ?? undefined)).toBe("map");
    expect(pictures[1]?.picture.focusMap).toBeNull();
  });

  it("of a request whose newer one was answered is acknowledged and not shown", async () => {
    const { live, socket, pictures } = connected();
    socket.open();
    live.request(request(1));
    live.request(request(2));
    socket.picture(2, 1);
    socket.picture(1, 2);
    await vi.advanceTimersByTimeAsync(0);
    expect(pictures.map(({ time }) => time)).toEqual([2]);
    expect(socket.sent.at(-1)).toEqual({ ack: 2 });
  });
});

describe("what is given up", () => {
  it("is stopped at the service, and what still comes of it is acknowledged and not heard", async () => {
    const { live, socket, pictures, said } = connected();
    socket.open();
    live.request(request(1));
    live.request(request(2));
    live.cancel();
    expect(socket.sent.at(-1)).toEqual({ stop: true });
    expect(live.free).toBe(true);
    socket.picture(2, 1);
    socket.say(JSON.stringify({ id: 2, status: 504, problem: { code: "timeout", detail: "Late.", path: null } }));
    await vi.advanceTimersByTimeAsync(0);
    expect([pictures, said]).toEqual([[], []]);
    expect(socket.sent.at(-1)).toEqual({ ack: 1 });
    live.request(request(3));
    socket.picture(3, 2);
    expect(pictures.map(({ time }) => time)).toEqual([3]);
  });

  it("is stopped once, and never asked for where there was no connection yet", () => {
    const { live, socket } = connected();
    live.request(request(1));
    live.cancel();
    socket.open();
    expect(socket.sent).toEqual([]);
    live.cancel();
    expect(socket.sent).toEqual([]);
  });
});

describe("a live connection that fails", () => {
  it("says nothing of what the service refuses before the newest", () => {
    const { live, socket, said } = connected();
    socket.open();
    live.request(request(1));
    live.request(request(2));
    const problem = { code: "bad", detail: "No such camera.", path: "/cam" };
    socket.say(JSON.stringify({ id: 1, status: 422, problem }));
    expect(said).toEqual([]);
    socket.say(JSON.stringify({ id: 2, status: 422, problem }));
    expect(said).toHaveLength(1);
  });

  it("tells what the service refuses", () => {
    const { live, socket, said } = connected();
    socket.open();
    live.request(request(1));
    socket.say(
      JSON.stringify({ id: 1, status: 422, problem: { code: "bad", detail: "No such camera.", path: "/cam" } }),
    );
    expect(said).toMatchObject([{ message: "No such camera.", status: 422, path: "/cam" }]);
    expect(live.free).toBe(true);
  });

  it("that is lost is unsaved again, later each time, until it is given up for good", async () => {
    const { live, sockets, states, socket } = connected();
    socket.open();
    live.request(request(1));
    socket.lose();
    expect(states).toEqual([true, false]);
    expect(live.free).toBe(true);
    await vi.advanceTimersByTimeAsync(500);
    expect(sockets).toHaveLength(2);
    sockets[1]?.lose();
    await vi.advanceTimersByTimeAsync(999);
    expect(sockets).toHaveLength(2);
    await vi.advanceTimersByTimeAsync(1);
    sockets[2]?.open();
    expect(sockets[2]?.sent).toEqual([]); // whoever waits is told, and asks again
    live.close();
    sockets[2]?.lose();
    await vi.advanceTimersByTimeAsync(60_000);
    expect(sockets).toHaveLength(3);
    expect(sockets[2]?.closed).toBe(true);
  });
});

describe("a lost live connection", () => {
  it("says so where others needed its place, and nothing where the network failed", () => {
    const { said, states, socket } = connected();
    socket.open();
    socket.lose(1013);
    expect(states).toEqual([true, false]);
    expect(said).toMatchObject([{ status: 503, code: "busy" }]);
    const cut = connected();
    cut.socket.open();
    cut.socket.lose();
    expect(cut.said).toEqual([]);
  });

  it("is opened again once the person is admitted, and not at all where nobody signs in", async () => {
    let signIn = (): void => undefined;
    const { sockets, socket } = connected(() => new Promise<void>((resolve) => (signIn = resolve)));
    socket.lose();
    await vi.advanceTimersByTimeAsync(60_000);
    expect(sockets).toHaveLength(1);
    signIn();
    await vi.advanceTimersByTimeAsync(0);
    expect(sockets).toHaveLength(2);

    const refused = connected(() => Promise.reject(errorOf(401, { code: "unauthorized", detail: "No." })));
    refused.socket.lose();
    const down = connected(() => Promise.reject(new UnreachableError()));
    down.socket.lose();
    await vi.advanceTimersByTimeAsync(60_000);
    expect([refused.sockets.length, vi.getTimerCount()]).toEqual([1, 1]); // the one that is down is tried on
  });
});

describe("others who look at the shot", () => {
  it("are told of, but for this page, and are gone with the connection", () => {
    const { socket, company } = connected();
    socket.open();
    const [name, camera] = ["anyone", "/cam"];
    const viewers = [1, 2].map((number) => ({ id: `v${number}`, name, number, camera, time: 10 * number }));
    socket.say(JSON.stringify({ you: "v1", viewers }));
    expect(company).toEqual([[["Guest 2", 20]]]);
    socket.lose();
    expect(company.at(-1)).toEqual([]);
  });

  it("hear of looks that need no picture a few times a second, the last one always", () => {
    const { socket, live } = connected();
    live.look(3);
    expect(socket.sent).toEqual([]);
    socket.open();
    for (let time = 4; time < 64; time += 1) {
      live.look(time);
      vi.advanceTimersByTime(1000 / 60);
    }
    vi.advanceTimersByTime(1000);
    expect(socket.sent.length).toBeLessThanOrEqual(6);
    expect([socket.sent[0], socket.sent.at(-1)]).toEqual([3, 63].map((time) => ({ here: { camera: "/cam", time } })));
  });

  it("hear of a request by itself", () => {
    const { socket, live } = connected();
    socket.open();
    for (const time of [3, 4]) live.look(time);
    live.request(request(5));
    vi.advanceTimersByTime(1000);
    expect(socket.sent.map(({ here, time }) => here ?? time)).toEqual([{ camera: "/cam", time: 3 }, 5]);
  });
});

it("live pictures are where the service is", () => {
  expect(liveAddress("https://there:8000", "a b", false)).toBe("wss://there:8000/v1/shots/a%20b/live");
  expect(liveAddress("https://there:8000", "a b", true)).toBe("wss://there:8000/v1/shots/a%20b/live?viewers=true");
});
