import { FrameLog } from "@/editor/frame_log";
import { UnreachableError } from "@/net/errors";
import { FakeRenders } from "./render_fixtures";

beforeEach(() => {
  vi.useFakeTimers();
});

afterEach(() => {
  vi.useRealTimers();
});

/** The log of a frame of a fake service. */
function logOf(...looks: readonly (readonly [string, boolean])[]): { service: FakeRenders; log: FrameLog } {
  const service = new FakeRenders();
  service.logs.push(...looks.map(([text, hasEnded]) => ({ text, hasEnded })));
  return { service, log: new FrameLog(() => service.log("r-1", 7, 2)) };
}

describe("the log of a frame", () => {
  it("is read again until its attempt has ended", async () => {
    const { service, log } = logOf(["one\n", false], ["one\ntwo\n", false], ["one\ntwo\nthree\n", true]);
    log.follow();
    await vi.advanceTimersByTimeAsync(1500);
    expect(log.text.value).toBe("one\ntwo\n");
    await vi.advanceTimersByTimeAsync(60_000);
    expect([log.text.value, service.calls]).toEqual(["one\ntwo\nthree\n", Array(3).fill("log r-1 7 2")]);
  });

  it("is not read any more once it is closed", async () => {
    const { service, log } = logOf(["one\n", false]);
    const stop = log.follow();
    await vi.advanceTimersByTimeAsync(0);
    stop();
    await vi.advanceTimersByTimeAsync(60_000);
    expect(service.calls).toHaveLength(1);
  });

  it("says why it cannot be read, and keeps what there was", async () => {
    const { service, log } = logOf(["one\n", false]);
    log.follow();
    await vi.advanceTimersByTimeAsync(0);
    service.failing = { log: new UnreachableError() };
    await vi.advanceTimersByTimeAsync(60_000);
    expect(log.text.value).toBe("one\n");
    expect(log.complaint.value).toMatch(/service/i);
    expect(service.calls).toHaveLength(2);
  });
});
