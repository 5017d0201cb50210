import { complaintOf, errorOf, isAbort, UnreachableError } from "@/net/errors";
import { HttpService } from "@/net/http";
import { Recent } from "@/net/recent";

const view = { shot: "demo", camera: "/World/cam" };

/** Answers every request and remembers what was asked. */
function answering(status: number, body: unknown): Request[] {
  const asked: Request[] = [];
  vi.stubGlobal("fetch", (request: Request) => {
    asked.push(request);
    return Promise.resolve(Response.json(body, { status }));
  });
  return asked;
}

afterEach(() => {
  vi.unstubAllGlobals();
});

describe("what the service says", () => {
  it("null distances are infinite", async () => {
    answering(200, {
      fStop: 2,
      focalLengthMm: 50,
      focusDistanceM: null,
      nearM: 30,
      farM: null,
      hyperfocalM: null,
      source: "camera",
      reason: "",
      focusMode: "manual",
    });
    const readout = await new HttpService("http://host").readout(view, 3);
    expect([readout.focusDistanceM, readout.farM, readout.hyperfocalM]).toEqual([Infinity, Infinity, Infinity]);
  });

  it("nothing under a click is null, not an error", async () => {
    answering(200, { hit: false });
    const quality = { width: 64, height: 36, rays: 1, layers: 1, supersample: 1, format: "png" } as const;
    expect(await new HttpService("http://host").pick(view, 1, [0.5, 0.5], quality)).toBeNull();
  });

  it("a refusal is its own sentence, and what to do", async () => {
    answering(422, { code: "bad_stage", detail: "night.usda is no USD stage", path: "night.usda", errors: [] });
    const error: unknown = await new HttpService("http://host").shots().catch((reason: unknown) => reason);
    expect(complaintOf(error)).toEqual({
      message: "night.usda is no USD stage.",
      advice: "Nothing was changed.",
      passing: false,
    });
  });

  it("an answer that is no JSON of ours is still an error with its status", () => {
    expect(errorOf(502, "<html>").message).toContain("502");
  });

  it("no answer at all says to look after the service", async () => {
    vi.stubGlobal("fetch", () => Promise.reject(new TypeError("Failed to fetch")));
    const error: unknown = await new HttpService("http://host").shots().catch((reason: unknown) => reason);
    expect(error).toBeInstanceOf(UnreachableError);
    expect(complaintOf(error).advice).toContain("pullfocus serve");
  });

  it("a request that a newer one replaced is no trouble for anybody", () => {
    expect(isAbort(errorOf(409, { code: "superseded", detail: "A newer request took its place." }))).toBe(true);
    expect(isAbort(errorOf(409, { code: "name_taken", detail: "Taken." }))).toBe(false);
  });
});

describe("what is asked of the service", () => {
  it("infinity is sent as the 0 that stands for it", async () => {
    const asked = answering(200, {});
    const command = { do: "setLens", change: { focusDistanceM: Infinity }, time: null } as const;
    await new HttpService("http://host").perform(view, command, 7);
    expect(asked[0]?.method).toBe("PATCH");
    expect(await asked[0]?.json()).toEqual({ focusDistanceM: 0 });
  });

  it("a prim path travels whole", async () => {
    const asked = answering(200, { focusPoints: [] });
    await new HttpService("http://host").focusPoints({ shot: "demo", camera: "/World/a b/cam&1" }, 7.5);
    const address = new URL(asked[0]?.url ?? "");
    expect(address.searchParams.get("camera")).toBe("/World/a b/cam&1");
    expect(address.searchParams.get("time")).toBe("7.5");
  });
});

describe("recent things", () => {
  it("keeps those used last", () => {
    const recent = new Recent<number>(2);
    recent.set("a", 1);
    recent.set("b", 2);
    recent.get("a");
    recent.set("c", 3);
    expect([recent.get("a"), recent.get("b"), recent.get("c")]).toEqual([1, undefined, 3]);
  });
});
