import { signal, type Signal } from "@preact/signals";
import { RenderForm, type RenderSource } from "@/editor/render_form";
import { errorOf, UnreachableError } from "@/net/errors";
import { SHOT } from "./fake_service";
import { FakeRenders, render } from "./render_fixtures";

interface Typed {
  readonly form: RenderForm;
  readonly service: FakeRenders;
  /** What is rendered; a test may change it. */
  readonly source: { revision: number; edits: Promise<void> };
  /** AOVs that are remembered. */
  readonly aovs: Signal<string>;
  /** What the last render made. */
  readonly delivered: Signal<string>;
}

function typed(remembered = "", made = ""): Typed {
  const service = new FakeRenders();
  const state = { revision: 0, edits: Promise.resolve() };
  const source: RenderSource = {
    shot: SHOT,
    camera: "/cam",
    aspect: 2,
    idle: () => state.edits,
    document: { revision: { peek: () => state.revision } },
    motion: { peek: () => 1 },
    playhead: { played: { peek: () => ({ ...SHOT.range, start: 10, end: 20 }) }, time: { peek: () => 12.4 } },
  };
  const [aovs, delivered] = [signal(remembered), signal(made)];
  const form = new RenderForm(service, source, "1920", { aovs, delivered });
  return { form, service, source: state, aovs, delivered };
}

beforeEach(() => {
  vi.useFakeTimers();
});

afterEach(() => {
  vi.useRealTimers();
});

/** Lets what is typed be tried. */
const rest = (): Promise<unknown> => vi.advanceTimersByTimeAsync(1000);

describe("a render that is typed", () => {
  it("begins with what is played, and is tried at once", async () => {
    const { form, service } = typed();
    await rest();
    expect(form.draft.value).toMatchObject({ frames: "10-20", width: "1920" });
    expect(service.planned.map(({ frames, camera }) => [frames, camera])).toEqual([["10-20", "/cam"]]);
    expect(form.plan.value?.count).toBe(96);
  });

  it("is tried after a rest, as it is then", async () => {
    const { form, service } = typed();
    await rest();
    for (const frames of ["1", "1-", "1-4"]) form.type({ frames });
    await rest();
    expect(service.planned.slice(1).map(({ frames }) => frames)).toEqual(["1-4"]);
  });

  it("is not tried nor sent with a field that cannot be read", async () => {
    const { form, service } = typed();
    await rest();
    form.type({ rays: "many" });
    expect(form.faults.value).toEqual([{ field: "rays", message: "Type a whole number, such as 100." }]);
    await rest();
    expect(await form.send()).toBeNull();
    expect([form.plan.value, service.planned.length, service.sent.length]).toEqual([null, 1, 0]);
  });

  it("is tried no more once it is closed", async () => {
    const { form, service } = typed();
    await rest();
    form.type({ width: "64" });
    form.close();
    await rest();
    expect(service.planned).toHaveLength(1);
  });
});

describe("AOVs of a render", () => {
  it("is tried and sent with the AOVs that were sent last, and with the renders that it waits for", async () => {
    const { form, service, aovs } = typed("depth,gone,primvars:st");
    expect(form.draft.value).toMatchObject({ aovs: ["depth"], primvars: "primvars:st", after: [] });
    form.type({ aovs: ["depth", "coc"], after: [render({ id: "r-7" })] });
    await rest();
    await form.send();
    const wanted = { aovs: ["depth", "coc", "primvars:st"], after: ["r-7"] };
    expect([service.planned.at(-1), service.sent[0]?.request]).toEqual([
      expect.objectContaining(wanted),
      expect.objectContaining(wanted),
    ]);
    expect(aovs.value).toBe("depth,coc,primvars:st");
  });

  it("remembers AOVs where it was taken, and where its files can hold some", async () => {
    const { form, service, aovs } = typed("depth");
    form.type({ aovs: ["normal"] });
    service.failing = { send: new UnreachableError() };
    await form.send();
    form.type({ formats: "png" });
    await form.send();
    expect([service.sent.at(-1)?.request.aovs, aovs.value]).toEqual([undefined, "depth"]);
    form.type({ formats: "both" });
    await form.send();
    expect([service.sent.at(-1)?.request.aovs, aovs.value]).toEqual([["normal"], "normal"]);
  });
});

describe("what a render makes", () => {
  it("is what the last one made, and remembered where it was taken", async () => {
    const { form, service, delivered } = typed("", "frames.png,movie.webm");
    expect(form.draft.value).toMatchObject({ made: ["frames", "movie"], formats: "png" });
    form.type({ made: ["focus-report"] });
    service.failing = { send: new UnreachableError() };
    await form.send();
    expect(delivered.value).toBe("frames.png,movie.webm");
    await form.send();
    expect(service.sent.at(-1)?.request).toMatchObject({ formats: [], products: ["focus-report.html"] });
    expect(delivered.value).toBe("focus-report.html");
  });

  it("is of frames that one press chooses", () => {
    const { form } = typed();
    const { start, end } = SHOT.range;
    expect((["this", "range", "whole"] as const).map((quick) => form.framesOf(quick))).toEqual([
      "12",
      "10-20",
      `${start}-${end}`,
    ]);
  });
});

describe("what stands against a render", () => {
  it("stands against a render: it is told at its field, and nothing is sent", async () => {
    const { form, service } = typed();
    await rest();
    service.findings = [
      { severity: "error", code: "bad_setting", path: "frames", message: "the step is 0" },
      { severity: "error", code: "unknown_stock", path: "", message: "there is no such film" },
      { severity: "warning", code: "not_honoured", path: "/World", message: "it is drawn otherwise" },
    ];
    form.type({ name: "dailies" });
    await rest();
    const faults = [
      { field: "frames", message: "The step is 0." },
      { field: null, message: "There is no such film." },
    ];
    expect([form.faults.value, form.plan.value]).toEqual([faults, null]);
    expect([await form.send(), service.sent, form.isSending.value]).toEqual([null, [], false]);
  });

  it("is asked for once more where the draft has changed, and not where it was found right", async () => {
    const { form, service } = typed();
    expect(form.isTrying.value).toBe(true);
    await rest();
    expect(form.isTrying.value).toBe(false);
    await form.send();
    expect([service.planned.length, service.sent.length]).toEqual([1, 1]);
    form.type({ frames: "1-2" });
    await form.send(); // before the rest after which it is tried
    expect([service.planned.length, service.sent.length]).toEqual([2, 2]);
  });

  it("may be a warning, which holds nothing up", async () => {
    const { form, service } = typed();
    service.findings = [{ severity: "warning", code: "x", path: "", message: "it is drawn otherwise" }];
    await rest();
    expect(form.plan.value?.findings).toEqual(service.findings);
    expect(await form.send()).not.toBeNull();
  });
});

describe("what the service finds", () => {
  it.each([
    [{ code: "settings", detail: "the step is 0", path: "frames" }, [{ field: "frames", message: "The step is 0." }]],
    [
      {
        code: "invalid_request",
        detail: "body.width: too wide; body.rays: too many",
        path: "body.width",
        errors: [
          { path: "body.width", detail: "too wide" },
          { path: "body.rays", detail: "too many" },
        ],
      },
      [
        { field: "width", message: "Too wide." },
        { field: "rays", message: "Too many." },
      ],
    ],
    [
      { code: "render_not_found", detail: "There is no render 'r-7'.", path: "render" },
      [{ field: "after", message: "There is no render 'r-7'." }],
    ],
    [
      {
        code: "invalid_request",
        detail: "body.aovs.1: no AOV",
        path: "body.aovs.1",
        errors: [{ path: "body.aovs.1", detail: "no AOV" }],
      },
      [{ field: "primvars", message: "No AOV." }],
    ],
    [
      { code: "too_costly", detail: "it takes too long", path: "body" },
      [{ field: null, message: "It takes too long. Nothing was changed." }],
    ],
  ])("is where it belongs: %o", async (problem, faults) => {
    const { form, service } = typed();
    await rest();
    service.failing = { plan: errorOf(422, problem) };
    form.type({ name: "dailies" });
    await rest();
    expect([form.faults.value, form.plan.value]).toEqual([faults, null]);
    form.type({ name: "dailies 2" });
    expect(form.faults.value).toEqual([]);
  });
});

describe("a render that is sent", () => {
  it("is sent once by a double click, after the edits under way", async () => {
    const { form, service, source } = typed();
    let made: () => void = () => undefined;
    source.edits = new Promise((resolve) => (made = resolve));
    const clicks = [form.send(), form.send()];
    await rest();
    expect([service.sent.length, form.isSending.value]).toEqual([0, true]);
    made();
    const [first, second] = await Promise.all(clicks);
    expect([first?.id, second]).toEqual([`r-${service.sent[0]?.key ?? ""}`, null]);
    expect([service.sent.length, form.isSending.value]).toEqual([1, false]);
  });

  it("has the same key when it is sent again, and another one with other content or edits", async () => {
    const { form, service, source } = typed();
    service.failing = { send: new UnreachableError() };
    expect(await form.send()).toBeNull();
    expect(form.faults.value[0]?.message).toMatch(/does not answer/);
    await form.send();
    form.type({ frames: "1-2" });
    await form.send();
    source.revision = 1;
    await form.send();
    const [first, again, other, edited] = service.sent.map(({ key }) => key);
    expect(again).toBe(first);
    expect(new Set([first, other, edited]).size).toBe(3);
    expect(first).toMatch(/^[0-9a-f]{32}$/);
  });
});
