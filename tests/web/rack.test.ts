import { rackProblem } from "@/model/rack";
import { opened } from "./pointed_session";
import { point } from "./points";

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

const SPAN = { start: 50, end: 62 };

describe("a rack", () => {
  it("goes from what is in focus to what is not yet", () => {
    expect(rackProblem(point("a"), point("b"), SPAN)).toBeNull();
    const keyed = [point("a", { weight: { 1: 1 } }), point("b", { weight: { 27: 0, 50: 0, 62: 1 } })] as const;
    expect(rackProblem(...keyed, SPAN)).toBeNull();
  });

  it("needs both to count", () => {
    expect(rackProblem(point("a", {}, { enabled: false }), point("b"), SPAN)).toBe("a is switched off at 50.");
    expect(rackProblem(point("a"), point("b", { enabled: { 1: 1, 60: 0 } }), SPAN)).toMatch("b is switched off at 62.");
  });

  it("is not where there are keys, nor what is in focus already", () => {
    expect(rackProblem(point("a", { weight: { 55: 1 } }), point("b"), SPAN)).toMatch("has a key at 55");
    expect(rackProblem(point("a", { weight: { 1: 0 } }), point("b"), SPAN)).toMatch("a is not in focus at 50");
    expect(rackProblem(point("a"), point("b", { weight: { 27: 1 } }), SPAN)).toMatch("b is in focus at 50 already");
  });

  it("ends where the service has frames", () => {
    expect(rackProblem(point("a"), point("b"), { start: 1, end: 1e9 })).toBeNull();
    expect(rackProblem(point("a"), point("b"), { start: 1, end: 1e9 + 1 })).toBe("The rack would end too far away.");
  });

  it("that cannot be is not sent, and that is said", async () => {
    const { fake, session, failed } = await opened();
    fake.points = [point("near", { weight: { 1: 0 } }), point("far")];
    session.document.refresh();
    expect(await session.pointEdits.rack(point("near"), "far", 12, "smooth")).toBe(false);
    expect([fake.made, failed.length]).toEqual([[], 1]);
    expect(await session.pointEdits.rack(point("far"), "near", 12, "smooth")).toBe(true);
    expect(fake.made[0]?.at(-1)).toMatchObject({ type: "rack", rack: { from: "far", to: "near" } });
  });
});
