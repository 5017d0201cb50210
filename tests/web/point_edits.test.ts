import type { Session } from "@/editor/session";
import { turn, type FakeService } from "./fake_service";
import { opened } from "./pointed_session";
import { point } from "./points";

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

interface Opening {
  readonly fake: FakeService;
  readonly session: Session;
}

/** Renames the point "far", as the service has it from then on. */
async function renameTo({ fake, session }: Opening, name: string): Promise<void> {
  fake.onMade = (changes) => {
    if (changes[0]?.type === "renamePoint" && changes[0].newName === name) fake.points = [point("near"), point(name)];
  };
  await session.pointEdits.rename(point("far"), name);
}

describe("a name", () => {
  it("that is typed becomes one that none has, and stays selected", async () => {
    const { fake, session } = await opened();
    await session.pointEdits.rename(point("far"), " near ");
    await session.pointEdits.rename(point("near"), "near");
    expect(fake.made).toEqual([[{ type: "renamePoint", name: "far", newName: "near_2" }]]);
    expect(session.selected.value).toBe("near_2");
  });

  it("that changes while a place is picked for the point lets the move go on", async () => {
    const { fake, session, failed } = await opened();
    let answer = (): void => undefined;
    fake.pickGate = () => new Promise((resolve) => (answer = resolve));
    const move = session.picks.move("far", [0.5, 0.5]);
    await turn();
    await renameTo({ fake, session }, "mara");
    answer();
    await move;
    expect(fake.made[1]).toMatchObject([{ type: "movePoint", name: "mara" }]);
    expect(failed).toEqual([]);
  });

  it("that is on its way holds up no edit before or after it, nor another name", async () => {
    const { fake, session, failed } = await opened();
    const before = session.pointEdits.setColor(point("far"), "teal");
    const rename = renameTo({ fake, session }, "mara");
    const row = session.pointEdits.identityOf("far");
    const after = session.pointEdits.setColor(point("far"), "red");
    const again = session.pointEdits.rename(point("far"), "bob");
    await Promise.all([before, rename, after, again]);
    expect(fake.made.flat().map((change) => "name" in change && change.name)).toEqual(["far", "far", "mara", "mara"]);
    expect(session.pointEdits.identityOf("bob")).toBe(row);
    expect(failed).toEqual([]);
  });

  it("that is refused leaves the point what it was", async () => {
    const { fake, session } = await opened();
    const row = session.pointEdits.identityOf("far");
    fake.failing = "renamePoint";
    expect(await session.pointEdits.rename(point("far"), "mara")).toBe(false);
    expect(session.pointEdits.identityOf("far")).toBe(row);
  });
});

describe("a subject", () => {
  it("follows a part from now on, or its surface again, in one edit", async () => {
    const { fake, session } = await opened();
    session.playhead.goTo(40);
    await session.pointEdits.follow(point("far"), "/World");
    await session.pointEdits.follow({ ...point("far"), part: "/World" }, "");
    const change = { type: "followPart", name: "far", time: 40 };
    expect(fake.made).toEqual([[{ ...change, part: "/World" }], [{ ...change, part: null }]]);
  });
});

describe("colours and groups of points", () => {
  it("are edits of one point each", async () => {
    const { fake, session } = await opened();
    const time = session.playhead.time.value;
    await session.pointEdits.setColor(point("far"), "teal");
    await session.pointEdits.setGroup(point("far"), " cast ");
    const made = [{ color: "teal" }, { group: "cast" }].map((values) => [
      { type: "alterPoint", name: "far", values, time },
    ]);
    expect(fake.made).toEqual(made);
    expect(await session.pointEdits.setGroup({ ...point("far"), group: "cast" }, "cast")).toBe(false);
    expect(fake.made).toHaveLength(2);
  });

  it("are not edited where the point is gone by then", async () => {
    const { fake, session, failed } = await opened();
    expect(await session.pointEdits.setColor(point("gone"), "teal")).toBe(false);
    expect(await session.pointEdits.rename(point("gone"), "new")).toBe(false);
    expect([fake.made, failed.length]).toEqual([[], 2]);
  });

  it("switch the points of a group that are not so yet, in one edit", async () => {
    const { fake, session } = await opened();
    const [off, on] = [point("off", {}, { enabled: false }), point("on")];
    fake.points = [off, on].map((each) => ({ ...each, group: "cast" })).concat(point("other", {}, { enabled: false }));
    session.document.pointsByTime.forget(null);
    await session.pointEdits.setGroupEnabled("cast", true);
    expect(fake.made.map((changes) => changes.map((change) => "name" in change && change.name))).toEqual([["off"]]);
  });

  it("fold a group, and unfold it", async () => {
    const { session } = await opened();
    session.foldGroup("a, b", true);
    expect([...session.foldedGroups.value]).toEqual(["a, b"]);
    session.foldGroup("a, b", false);
    expect(session.foldedGroups.value.size).toBe(0);
  });
});

describe("what is done to a point while an edit of it is under way", () => {
  const DOINGS: readonly [string, (session: Session) => void][] = [
    [
      "a value",
      (session) => {
        session.dragPoint("weight", point("far"), "weight").commit(0.5);
      },
    ],
    [
      "a pull",
      (session) => {
        session.pullTo(point("far"));
      },
    ],
  ];

  it.each(DOINGS)("is not sent where that removes it, and that is said: %s", async (_, act) => {
    const { fake, session, failed } = await opened();
    fake.onMade = () => {
      fake.points = [point("near")];
    };
    const removed = session.pointEdits.remove(point("far"));
    act(session);
    await removed;
    await session.idle();
    expect(fake.made).toEqual([[{ type: "removePoint", name: "far" }]]);
    expect(failed).toMatchObject([{ message: "There is no far any more." }]);
    expect(session.document.unsaved.value).toEqual([]);
  });

  it.each(DOINGS)("follows it to another name: %s", async (_, act) => {
    const { fake, session, failed } = await opened();
    const renamed = renameTo({ fake, session }, "mara");
    act(session);
    await renamed;
    await session.idle();
    const names = fake.made[1]?.flatMap((change) => ("name" in change ? [change.name] : [])) ?? [];
    expect(names).toContain("mara");
    expect(names).not.toContain("far");
    expect(failed).toEqual([]);
  });
});
