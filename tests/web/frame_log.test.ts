import { FrameLog } from "@/editor/frame_log";
import { errorOf, UnreachableError } from "@/net/errors";
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

  it("says why it cannot be read, keeps what there was, and goes on", async () => {
    const { service, log } = logOf(["one\n", false], ["one\ntwo\n", true]);
    log.follow();
    await vi.advanceTimersByTimeAsync(0);
    service.failing = { log: new UnreachableError() };
    await vi.advanceTimersByTimeAsync(2000);
    expect([log.text.value, log.complaint.value]).toEqual(["one\n", expect.stringMatching(/service/i)]);
    await vi.advanceTimersByTimeAsync(60_000);
    expect([log.text.value, log.complaint.value, service.calls.length]).toEqual(["one\ntwo\n", null, 3]);
  });

  it("is given up where the service refuses it", async () => {
    const { service, log } = logOf();
    service.failing = { log: errorOf(404, { code: "render_not_found", detail: "There is no render 'r-1'." }) };
    log.follow();
    await vi.advanceTimersByTimeAsync(60_000);
    expect([log.complaint.value, service.calls.length]).toEqual([expect.stringMatching(/r-1/), 1]);
  });
});
