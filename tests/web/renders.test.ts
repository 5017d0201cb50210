import { chosenProducts } from "@/model/deliverables";
import { faultsIn, fieldOf, framesOf, requestOf, type RenderDraft } from "@/model/render_draft";
import {
  durationInWords,
  failuresOf,
  framesInWords,
  groupsOf,
  isTaken,
  lastDrawn,
  planInWords,
  progressInWords,
  RENDER_ACTIONS,
  settingsInWords,
  stateInWords,
  waitableOf,
  type Render,
} from "@/model/renders";
import { render, task } from "./render_fixtures";

describe("what the service takes", () => {
  // As service/jobs/queue.py has it.
  it.each<[string, Partial<Render>, string[]]>([
    ["queued", {}, ["pause", "cancel"]],
    ["running", { ready: 3, running: 1 }, ["pause", "cancel"]],
    ["running", { ready: 2, running: 1, failed: 1 }, ["pause", "retry", "cancel"]],
    ["pause-requested", { ready: 3, running: 1 }, ["resume", "cancel"]],
    ["paused", { ready: 3, done: 1 }, ["resume", "cancel"]],
    ["cancel-requested", { ready: 0, running: 1, canceled: 3 }, ["retry"]],
    ["canceled", { ready: 0, done: 1, canceled: 3 }, ["accept", "retry", "remove"]],
    ["failed", { ready: 0, done: 3, failed: 1 }, ["accept", "retry", "remove"]],
    ["done", { ready: 0, done: 3, failed: 1, accepted: true }, ["retry", "remove"]],
    ["done", { ready: 0, done: 4 }, ["remove"]],
  ])("of a render that is %s with %o: %j", (state, counts, taken) => {
    const now = render({ ...counts, state: state as Render["state"] });
    expect(RENDER_ACTIONS.filter((action) => isTaken(action, now))).toEqual(taken);
  });
});

describe("a plan in words", () => {
  it("a plan tells the picture that it is of", () => {
    const settings = {
      camera: "/World/cam",
      width: 480,
      height: 360,
      lensName: "Planar 50 mm f/1.4",
      lensModel: "prescription",
      fStop: 2.83,
      focalLengthMm: 50,
      film: "velvia_50",
      engine: "lens",
      rays: 16,
      formats: ["exr"],
      aovs: [],
      revision: "5a302e56",
    } as const;
    expect(settingsInWords({ settings })).toBe("480 × 360 px, Planar 50 mm f/1.4 at f/2.8, on velvia_50");
    expect(settingsInWords({ settings: { ...settings, lensName: "", fStop: 0, film: null } })).toBe(
      "480 × 360 px, 50 mm",
    );
    expect(settingsInWords({ settings: null })).toBe("");
  });
});

describe("in words", () => {
  it.each([
    [0.2, "1 s"],
    [89, "89 s"],
    [90, "2 min"],
    [3600, "60 min"],
    [5400, "1 h 30 min"],
    [12_000, "3 h 20 min"],
    [40_000, "11 h"],
    [1_000_000, "12 days"],
  ])("%d s are %s", (seconds, words) => {
    expect(durationInWords(seconds)).toBe(words);
  });

  it("a plan has its frames and its work", () => {
    expect(planInWords({ count: 9600, secondsOfProcessor: 120 })).toBe("9,600 frames, about 2 min of work");
    expect(planInWords({ count: 1, secondsOfProcessor: 3 })).toBe("1 frame, about 3 s of work");
  });

  it("a render tells how far it is, and what went wrong", () => {
    const ended = render({ state: "failed", ready: 0, done: 2, failed: 1, canceled: 1 });
    expect(progressInWords(ended)).toBe("2 of 4 frames, 1 failed, 1 given up");
    expect(stateInWords(ended, [])).toBe("Ended with failures");
    expect(progressInWords(render())).toBe("0 of 4 frames");
    expect(stateInWords(render({ ...ended, state: "done", accepted: true }), [])).toBe("Accepted as it is");
    expect(stateInWords(render({ state: "queued" }), [])).toBe("Waits for its turn");
  });

  it("a render tells those that it waits for by name where they are few and known", () => {
    const named = (...names: string[]): Render[] => names.map((name) => render({ id: `r-${name}`, name }));
    const waiting = (...names: string[]): Render => render({ waitsFor: names.map((name) => `r-${name}`) });
    expect(stateInWords(waiting("b", "a"), named("a", "b", "c"))).toBe("Waits for a, b");
    expect(stateInWords(waiting("a", "old"), named("a", "b"))).toBe("Waits for 2 other renders");
    expect(stateInWords(waiting("a", "b", "c", "d"), named("a", "b", "c", "d"))).toBe("Waits for 4 other renders");
    expect(stateInWords(waiting("old"), [])).toBe("Waits for 1 other render");
  });

  it("frames are runs", () => {
    expect(framesInWords([1, 2, 3, 8, -4].toSorted((a, b) => a - b))).toBe("-4, 1–3, 8");
  });
});

describe("a render can wait", () => {
  const states: Render["state"][] = ["queued", "running", "paused", "failed", "canceled", "done"];
  const all = states.map((state) => render({ id: `r-${state}`, state }));

  it("for those that are not done", () => {
    expect(waitableOf(all, []).map(({ state }) => state)).toEqual(states.slice(0, -1));
  });

  it("for those that were chosen and are done by now, or not in the list any more", () => {
    const chosen = [render({ id: "r-done" }), render({ id: "r-gone" }), render({ id: "r-paused" })];
    const added = waitableOf(all, chosen).slice(5);
    expect(added).toEqual([all[5], chosen[1]]);
  });
});

describe("the frames of a render", () => {
  it("are cells of their own where they are few", () => {
    const groups = groupsOf([task(1, "done"), task(2, "running"), task(3, "ready")], 120);
    expect(groups.map(({ label }) => label)).toEqual(["Frame 1: drawn", "Frame 2: being drawn", "Frame 3: waiting"]);
  });

  it("are few cells where they are many, and none is left out", () => {
    const tasks = Array.from({ length: 10_000 }, (_, at) => task(at + 1, at === 8_400 ? "failed" : "done"));
    const groups = groupsOf(tasks, 120);
    expect(groups.length).toBeLessThanOrEqual(120);
    expect(groups.flatMap((group) => group.tasks)).toEqual(tasks);
    const failed = groups.filter(({ state }) => state === "failed");
    expect(failed.map(({ label }) => label)).toEqual(["Frames 8401 to 8484: 1 failed, 83 drawn"]);
  });

  it("that were drawn last have the picture that is shown", () => {
    const tasks = [task(1, "done", 3), task(2, "done", 9), task(3, "done", 5), task(4, "failed", 12)];
    expect(lastDrawn(tasks)?.frame).toBe(2);
    expect(lastDrawn([task(1, "ready")])).toBeNull();
  });

  it("that failed are told by their reasons, the most frequent first", () => {
    const tasks = [task(1, "failed", 1, "No disk."), task(2, "failed", 1, "No lens."), task(3, "done", 1)];
    expect(failuresOf([...tasks, task(4, "failed", 1, "No lens.")])).toEqual([
      { error: "No lens.", frames: [2, 4] },
      { error: "No disk.", frames: [1] },
    ]);
  });
});

const draft: RenderDraft = {
  name: " ",
  frames: "1-9:2",
  width: "640",
  rays: "16",
  ...chosenProducts("frames.png"),
  priority: "50",
  aovs: [],
  primvars: "",
  after: [],
};
const view = { shot: "demo", camera: "/World/cam", layers: 4, supersample: 0, motion: 16 };

describe("a draft", () => {
  it("has the whole frames of what is played", () => {
    expect(framesOf({ start: 1, end: 96, framesPerSecond: 24 })).toBe("1-96");
    expect(framesOf({ start: -2.5, end: 3.5, framesPerSecond: 24 })).toBe("-2-3");
    expect(framesOf({ start: 7, end: 7, framesPerSecond: 24 })).toBe("7");
  });

  it("asks for the picture that the page shows, with each moment of its motion drawn", () => {
    expect(requestOf(draft, view)).toEqual({
      shot: "demo",
      camera: "/World/cam",
      name: "",
      frames: "1-9:2",
      width: 640,
      rays: 16,
      formats: ["png"],
      priority: 50,
      engine: "lens",
      layers: 4,
      supersample: 0,
      motion: 16,
      motionBy: "moments",
    });
  });

  it("leaves out the shot's own camera, and the frames where all are meant", () => {
    const request = requestOf({ ...draft, frames: "  " }, { ...view, camera: null });
    expect([request.frames, request.camera]).toEqual([undefined, undefined]);
  });
});

describe("AOVs and renders before, in a draft", () => {
  it("asks for AOVs in EXR files alone, in the order of their parts, each once", () => {
    const typed = { ...draft, aovs: ["coc", "depth"], primvars: " st, primvars:displayColor st" };
    const aovs = ["depth", "coc", "primvars:st", "primvars:displayColor"];
    expect(requestOf({ ...typed, formats: "both" }, view).aovs).toEqual(aovs);
    expect(requestOf({ ...typed, formats: "exr" }, view).aovs).toEqual(aovs);
    expect(requestOf(typed, view)).not.toHaveProperty("aovs");
  });

  it("waits for the renders that are chosen", () => {
    const after = [render({ id: "r-2" }), render({ id: "r-1" })];
    expect(requestOf({ ...draft, after }, view).after).toEqual(["r-2", "r-1"]);
    const many = Array.from({ length: 17 }, (_, at) => render({ id: `r-${at}` }));
    expect(faultsIn({ ...draft, after: many.slice(1) })).toEqual([]);
    expect(faultsIn({ ...draft, after: many })).toEqual([
      { field: "after", message: "A render waits for 16 others at most." },
    ]);
  });

  it("has faults in its primvars where they count", () => {
    const nameless = { ...draft, primvars: "st primvars:" };
    const fault = { field: "primvars", message: "Type a name behind primvars:, such as primvars:st." };
    expect([faultsIn({ ...nameless, formats: "exr" }), faultsIn(nameless)]).toEqual([[fault], []]);
    const many = Array.from({ length: 32 }, (_, at) => `p${at}`).join(" ");
    expect(faultsIn({ ...draft, formats: "exr", primvars: many })).toEqual([]);
    expect(faultsIn({ ...draft, formats: "exr", primvars: many, aovs: ["coc"] })).toEqual([
      { field: "primvars", message: "A render has 32 AOVs at most." },
    ]);
  });
});

describe("faults of a draft", () => {
  it("has its faults at their fields", () => {
    const typed = { ...draft, width: "wide", rays: "", priority: "1.5" };
    expect(faultsIn(typed).map(({ field }) => field)).toEqual(["width", "rays", "priority"]);
    expect(faultsIn(draft)).toEqual([]);
    const beyond = faultsIn({ ...draft, width: "9000", rays: "0", priority: "101", frames: "[" });
    expect(beyond.map(({ message }) => message)).toEqual([
      "Type frames such as 1-10:2,15.",
      "Type 8192 or less.",
      "Type 1 or more.",
      "Type 100 or less.",
    ]);
    expect(["body.width", "frames", "body", "shot", null].map(fieldOf)).toEqual(["width", "frames", null, null, null]);
    expect(["body.aovs.12", "body.after.0", "render"].map(fieldOf)).toEqual(["primvars", "after", "after"]);
  });
});
