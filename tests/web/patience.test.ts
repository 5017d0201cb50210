import { errorOf, isAbort, type ServiceError } from "@/net/errors";
import { HttpService } from "@/net/http";
import { Patience, type PatienceListener } from "@/net/patience";

const BUSY = { code: "busy", detail: "All workers are busy." };

function refusal(status: number, retryAfter: string | null = null): ServiceError {
  return errorOf(status, BUSY, retryAfter);
}

/** An attempt that is refused so often, and counts. */
function refused(times: number, error: ServiceError): { attempt: () => Promise<string>; made: () => number } {
  let made = 0;
  const attempt = (): Promise<string> => {
    made += 1;
    return made > times ? Promise.resolve("done") : Promise.reject(error);
  };
  return { attempt, made: () => made };
}

function patient(signedIn = true): { patience: Patience; asked: () => number; waits: (number | null)[] } {
  const patience = new Patience();
  const waits: (number | null)[] = [];
  let asked = 0;
  const listener: PatienceListener = {
    onSignInNeeded: () => {
      asked += 1;
      return Promise.resolve(signedIn);
    },
    onWaiting: (error, waitS) => waits.push(error && waitS),
  };
  patience.listener = listener;
  return { patience, asked: () => asked, waits };
}

beforeEach(() => {
  vi.useFakeTimers();
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe("a refusal for want of a key", () => {
  it("is followed by the same request, once somebody has signed in", async () => {
    const { patience, asked } = patient();
    const { attempt, made } = refused(2, refusal(401));
    expect(await patience.send(attempt, false)).toBe("done");
    expect([asked(), made()]).toEqual([2, 3]);
  });

  it("is an error where nobody does", async () => {
    const { patience } = patient(false);
    await expect(patience.send(refused(1, refusal(401)).attempt, true)).rejects.toMatchObject({ status: 401 });
    await expect(new Patience().send(refused(1, refusal(401)).attempt, true)).rejects.toMatchObject({ status: 401 });
  });
});

describe("a refusal for a while", () => {
  it("is waited out as long as the service says, and longer each time", async () => {
    const { patience, waits } = patient();
    const { attempt, made } = refused(3, refusal(429, "3"));
    const sent = patience.send(attempt, false);
    await vi.advanceTimersByTimeAsync(2999);
    expect([made(), waits]).toEqual([1, [3]]);
    await vi.advanceTimersByTimeAsync(3001);
    expect(made()).toBe(3);
    await vi.advanceTimersByTimeAsync(4000);
    expect(await sent).toBe("done");
    expect(waits).toEqual([3, null, 3, null, 4, null]);
  });

  it("is an error after so many waits, where it asks for none, or for too long a one", async () => {
    const { patience } = patient();
    const { attempt, made } = refused(99, refusal(503, "1"));
    const failed = expect(patience.send(attempt, true)).rejects.toMatchObject({ status: 503 });
    await vi.advanceTimersByTimeAsync(60_000);
    await failed;
    expect(made()).toBe(5);
    await expect(patience.send(refused(1, refusal(503)).attempt, true)).rejects.toMatchObject({ status: 503 });
    await expect(patience.send(refused(1, refusal(429, "600")).attempt, true)).rejects.toMatchObject({ status: 429 });
  });

  it("of a change may come after part of it, so that it is not sent again", async () => {
    const { patience } = patient();
    await expect(patience.send(refused(1, refusal(503, "1")).attempt, false)).rejects.toMatchObject({ status: 503 });
  });

  it("ends with its request", async () => {
    const { patience, waits } = patient();
    const abort = new AbortController();
    const { attempt, made } = refused(1, refusal(429, "3"));
    const failed = patience.send(attempt, true, abort.signal).catch((error: unknown) => isAbort(error));
    await vi.advanceTimersByTimeAsync(10);
    abort.abort();
    expect([await failed, made(), waits]).toEqual([true, 1, [3, null]]);
  });
});

it("an edit that a revoked key could not make is made, whole, after signing in", async () => {
  const bodies: unknown[] = [];
  let isIn = false;
  vi.stubGlobal("fetch", async (request: Request) => {
    bodies.push(await request.json());
    if (!isIn) return Response.json({ code: "unauthorized", detail: "No." }, { status: 401 });
    return Response.json({
      history: { revision: "r", undo: null, redo: null },
      changed: [],
      simplified: [],
      state: null,
    });
  });
  const service = new HttpService("http://host");
  const onSignInNeeded = (): Promise<boolean> => Promise.resolve((isIn = true));
  service.listen({ onSignInNeeded, onWaiting: () => undefined });
  const edit = { label: "f", changes: [], time: 1, withCurve: false };
  const { history } = await service.edit({ shot: "demo", camera: "/cam" }, edit);
  expect(history.revision).toBe("r");
  expect(bodies).toHaveLength(2);
  expect(bodies[0]).toEqual(bodies[1]);
});

it("a wrong key is told and not asked for again", async () => {
  const answer = { code: "unauthorized", detail: "The key is wrong, expired or revoked." };
  vi.stubGlobal("fetch", () => Promise.resolve(Response.json(answer, { status: 401 })));
  const service = new HttpService("http://host");
  const onSignInNeeded = vi.fn(() => Promise.resolve(true));
  service.listen({ onSignInNeeded, onWaiting: () => undefined });
  await expect(service.signIn("pf_wrong")).rejects.toThrow(answer.detail);
  expect(onSignInNeeded).not.toHaveBeenCalled();
});
