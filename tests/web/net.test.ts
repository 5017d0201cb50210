import { restQuality } from "@/model/quality";
import type { Change, Changes } from "@/model/changes";
import { complaintOf, errorOf, isAbort, UnreachableError } from "@/net/errors";
import { base64Of } from "@/net/files";
import { HttpService } from "@/net/http";
import { Recent } from "@/net/recent";
import { point } from "./points";

const view = { shot: "demo", camera: "/World/cam" };
const HISTORY = { revision: "r1", before: null, after: null, undo: null, redo: null };
/** Answer to an edit that says nothing of the state. */
const NOTHING = { history: HISTORY, changed: [], added: [], racks: [], simplified: [], imported: null, state: null };

/** Answers every request and records the requests. */
function answering(status: number, body: unknown): Request[] {
  const requests: Request[] = [];
  vi.stubGlobal("fetch", (request: Request) => {
    requests.push(request);
    return Promise.resolve(Response.json(body, { status }));
  });
  return requests;
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
      closeFocusM: null,
      pupilToFilmMm: [50, 55],
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
      remedy: null,
    });
  });

  it("without a key says so to a person, and offers to sign in", () => {
    const error = errorOf(401, { code: "unauthorized", detail: "Send it as `Authorization: Bearer KEY`." });
    expect(complaintOf(error)).toMatchObject({ message: "You are not signed in.", remedy: "signIn" });
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

describe("requests to the service", () => {
  it("an edit is one request, with all that its answer must have", async () => {
    const requests = answering(200, NOTHING);
    const rack: Change = { type: "rack", rack: { from: "a", to: "b", start: 5, end: 17, ease: "smooth" } };
    const changes: Changes = [{ type: "setFocus", values: { mode: "points" } }, rack];
    await new HttpService("http://host").edit(view, { label: "Rack to b", changes, time: 5, withCurve: true });
    expect(requests.map(({ method, url }) => [method, new URL(url).pathname])).toEqual([
      ["POST", "/v1/shots/demo/edits"],
    ]);
    const answer = { time: 5, curve: true };
    expect(await requests[0]?.json()).toEqual({ camera: "/World/cam", label: "Rack to b", changes, answer });
  });

  it("a part of the answer that the service could not read is null, and is no failure", async () => {
    answering(200, NOTHING);
    const edited = await new HttpService("http://host").edit(view, {
      label: "",
      changes: [],
      time: 5,
      withCurve: true,
    });
    expect([edited.points, edited.readout, edited.photography, edited.curve]).toEqual([null, null, null, null]);
    expect([edited.history.revision, edited.history.undo]).toEqual(["r1", ""]);
  });

  it("a focus report has an address for each of its formats", () => {
    const { renders } = new HttpService("http://host");
    expect([renders.reportAddress("r-1", "csv"), renders.reportAddress("r/2", "json")]).toEqual([
      "http://host/v1/renders/r-1/focus-report?format=csv",
      "http://host/v1/renders/r%2F2/focus-report?format=json",
    ]);
  });

  it("the content of a file travels as base64", async () => {
    expect(await base64Of(new Blob([new Uint8Array([0, 255, 128])]))).toBe("AP+A");
    expect(atob(await base64Of(new Blob(["a".repeat(20_000)])))).toBe("a".repeat(20_000));
  });

  it("a prim path travels whole", async () => {
    const requests = answering(200, { focusPoints: [] });
    await new HttpService("http://host").focusPoints({ shot: "demo", camera: "/World/a b/cam&1" }, 7.5);
    const address = new URL(requests[0]?.url ?? "");
    expect(address.searchParams.get("camera")).toBe("/World/a b/cam&1");
    expect(address.searchParams.get("time")).toBe("7.5");
  });
});

const alter: Change = { type: "alterPoint", name: "a", values: { weight: 0.5 }, time: 1 };
const add: Change = { type: "addPoint", point: { name: "b", ...point("b").anchor } };
const key: Change = { type: "keyPoint", name: "b", attribute: "weight", key: { time: 1, value: 1 } };

/** Answers as a service whose list of points has tags `list-n` and `a-n`, n of the requested time. */
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
    if (request.url.endsWith("/undo")) return Promise.resolve(Response.json({ ...HISTORY, now: 0, steps: [] }));
    const changed = ["focus-points", "focus-points/a", "focus-points/b"].map((resource) => ({
      resource,
      etag: `"${resource} ${sent.length}"`,
    }));
    return Promise.resolve(Response.json({ ...NOTHING, changed }));
  });
  return sent;
}

function edit(service: HttpService, ...changes: Changes): Promise<unknown> {
  return service.edit(view, { label: "", changes, time: 1, withCurve: false });
}

describe("entity tags", () => {
  it("an edit is made upon what was read first, the next one upon the answer to that", async () => {
    const sent = tagging();
    const service = new HttpService("http://host");
    await service.focusPoints(view, 1);
    await service.focusPoints(view, 2); // another time: the person may have seen the first
    await edit(service, alter);
    await edit(service, alter);
    expect(sent).toEqual(['"a-1"', '"focus-points/a 1"']);
  });

  it("an edit names all that it is made upon, a point that it adds excepted", async () => {
    const sent = tagging();
    const service = new HttpService("http://host");
    await service.focusPoints(view, 1);
    await edit(service, add, key, alter);
    await edit(service, key);
    expect(sent).toEqual(['"list-1", "a-1"', '"focus-points/b 1"']);
  });

  it("where one of the tags is not known the edit is made upon whatever is there", async () => {
    const sent = tagging();
    const service = new HttpService("http://host");
    await service.focusPoints(view, 1);
    await edit(service, alter, { type: "setCamera", values: { fStop: 4 } });
    expect(sent).toEqual([null]);
  });

  it("a reading that an edit overtook does not count, nor does one after an undo know what was before it", async () => {
    const sent = tagging();
    const service = new HttpService("http://host");
    const read = service.focusPoints(view, 1);
    await edit(service, alter);
    await read;
    await edit(service, alter);
    await service.undo("demo", "now");
    await edit(service, alter);
    expect(sent).toEqual([null, '"focus-points/a 1"', '"now"', null]);
  });

  it("a refusal is reported in a sentence, and the resource read anew before it is edited again", async () => {
    const sent = tagging(true);
    const service = new HttpService("http://host");
    await service.focusPoints(view, 1);
    const error: unknown = await edit(service, alter).catch((reason: unknown) => reason);
    expect(complaintOf(error).message).toBe("Somebody else changed this meanwhile.");
    await service.focusPoints(view, 2);
    await edit(service, alter).catch(() => undefined);
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
