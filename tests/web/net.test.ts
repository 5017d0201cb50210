import { restQuality } from "@/model/quality";
import type { Command } from "@/model/command";
import { complaintOf, errorOf, isAbort, UnreachableError } from "@/net/errors";
import { HttpService } from "@/net/http";
import { Recent } from "@/net/recent";
import { point } from "./points";

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
    const quality = restQuality(64, 36);
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
    await new HttpService("http://host").perform(view, command, 7, "g");
    expect(asked[0]?.method).toBe("PATCH");
    expect(await asked[0]?.json()).toEqual({ focusDistanceM: 0 });
  });

  it("a rack, and how the focus is found, go where they belong", async () => {
    const asked = answering(201, {});
    const service = new HttpService("http://host");
    const rack = { from: "a", to: "b", start: 5, end: 17, ease: "smooth" } as const;
    await service.perform(view, { do: "rack", rack }, 5, "g");
    await service.perform(view, { do: "setFocus", change: { mode: "surface" }, time: null }, 5, "g");
    expect(asked.map(({ method, url }) => [method, new URL(url).pathname])).toEqual([
      ["POST", "/v1/shots/demo/racks"],
      ["PATCH", "/v1/shots/demo/camera/focus"],
    ]);
    expect(await asked[0]?.json()).toEqual(rack);
    expect(await asked[1]?.json()).toEqual({ mode: "surface" });
    expect(new URL(asked[0]?.url ?? "").searchParams.get("gesture")).toBe("g");
  });

  it("a prim path travels whole", async () => {
    const asked = answering(200, { focusPoints: [] });
    await new HttpService("http://host").focusPoints({ shot: "demo", camera: "/World/a b/cam&1" }, 7.5);
    const address = new URL(asked[0]?.url ?? "");
    expect(address.searchParams.get("camera")).toBe("/World/a b/cam&1");
    expect(address.searchParams.get("time")).toBe("7.5");
  });
});

const change: Command = { do: "changePoint", name: "a", change: { weight: 0.5 } };

/** Answers as a service whose list of points has tags `list-n` and `a-n`, n of the time that is asked for. */
function tagging(refuse = false): (string | null)[] {
  const sent: (string | null)[] = [];
  vi.stubGlobal("fetch", (request: Request) => {
    const time = new URL(request.url).searchParams.get("time") ?? "";
    if (request.method === "GET") {
      const a = { name: "a", etag: `"a-${time}"`, keys: {}, target: ["/a"] };
      return Promise.resolve(Response.json({ etag: `"list-${time}"`, focusPoints: [a] }));
    }
    sent.push(request.headers.get("if-match"));
    if (refuse) return Promise.resolve(Response.json({ code: "changed_meanwhile", detail: "No" }, { status: 412 }));
    return Promise.resolve(Response.json({}, { headers: { ETag: '"answer"' } }));
  });
  return sent;
}

describe("entity tags", () => {
  it("an edit is made upon what was read first, the next one upon the answer to that", async () => {
    const sent = tagging();
    const service = new HttpService("http://host");
    await service.focusPoints(view, 1);
    await service.focusPoints(view, 2); // another time: the person may have seen the first
    await service.perform(view, change, 1, "g");
    await service.perform(view, change, 1, "g");
    expect(sent).toEqual(['"a-1"', '"answer"']);
  });

  it("a point is added to the list that was read; after that the list is unknown until it is read", async () => {
    const sent = tagging();
    const service = new HttpService("http://host");
    const add: Command = { do: "addPoint", name: "b", anchor: point("b").anchor };
    await service.focusPoints(view, 1);
    await service.perform(view, add, 1, "g");
    await service.perform(view, { ...change, name: "b" }, 1, "g");
    await service.perform(view, add, 1, "g");
    await service.focusPoints(view, 3);
    await service.perform(view, add, 1, "g");
    expect(sent).toEqual(['"list-1"', '"answer"', null, '"list-3"']);
  });

  it("a reading that an edit overtook does not count, nor does one after an undo know what was before it", async () => {
    const sent = tagging();
    const service = new HttpService("http://host");
    const read = service.focusPoints(view, 1);
    await service.perform(view, change, 1, "g");
    await read;
    await service.perform(view, change, 1, "g");
    await service.restore("demo", "then", "now", "g");
    await service.perform(view, change, 1, "g");
    expect(sent).toEqual([null, '"answer"', '"now"', null]);
  });

  it("what was refused is told in a sentence, and read anew before it is edited again", async () => {
    const sent = tagging(true);
    const service = new HttpService("http://host");
    await service.focusPoints(view, 1);
    const error: unknown = await service.perform(view, change, 1, "g").catch((reason: unknown) => reason);
    expect(complaintOf(error).message).toBe("Somebody else changed this meanwhile.");
    await service.focusPoints(view, 2);
    await service.perform(view, change, 1, "g").catch(() => undefined);
    expect(sent).toEqual(['"a-1"', '"a-2"']);
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
