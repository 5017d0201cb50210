import type { Session } from "@/editor/session";
import type { TopView } from "@/model/top_view";
import { addressOf, CAMERA } from "@/net/tags";
import { turn, type FakeService } from "./fake_service";
import { opened } from "./pointed_session";

const PLACE = { slope: 0, nearW: 0.6, focusW: 0.5, farW: 0.4 };
/** At (0, 1, 0), looking along -Z, focused at 2 m. */
const VIEW: TopView = {
  positionM: [0, 1, 0],
  right: [1, 0, 0],
  ahead: [0, 0, -1],
  setBackM: 0,
  gateMm: 36,
  edges: [-0.5, 0.5],
  axis: PLACE,
  cut: [PLACE],
};

/** A session whose camera is read when that is let through. */
async function held(): Promise<{ fake: FakeService; session: Session; failed: unknown[]; read: () => void }> {
  const { fake, session, failed } = await opened();
  session.selected.value = null;
  let read = (): void => undefined;
  const view = new Promise<TopView>((resolve) => {
    read = () => {
      resolve(VIEW);
    };
  });
  Object.assign(fake, { fromAbove: { ...fake.fromAbove, topView: () => view } });
  return { fake, session, failed, read };
}

const DOLLIED = { type: "moveCamera", positionM: [0, 1, -1], ahead: [0, 0, -1], up: [0, 1, 0], time: 1 };

/** Changes as they are sent: JSON has no -0. */
function sent(changes: unknown): unknown {
  return JSON.parse(JSON.stringify(changes));
}

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

describe("a hand on the camera", () => {
  it("shows its moves once the camera is known, and makes them one edit", async () => {
    const { fake, session, read } = await held();
    session.cameraMoves.move("dolly", [0.25, 0]);
    session.cameraMoves.move("dolly", [0.25, 0]);
    expect(session.document.unsaved.value).toEqual([]);
    read();
    await turn();
    const shown = { ...DOLLIED, keyed: false, positionM: [0, 1, expect.closeTo(-1, 9) as number] };
    expect(sent(session.document.unsaved.value)).toEqual([shown]);
    expect(fake.made).toEqual([]);
    await session.cameraMoves.end();
    expect(sent(fake.made)).toEqual([[shown]]);
    expect([session.document.unsaved.value, session.document.dragging.value]).toEqual([[], false]);
  });

  it("leaves the camera where it was when it is called off", async () => {
    const { fake, session, read } = await held();
    session.cameraMoves.move("pan", [0.25, 0]);
    read();
    await turn();
    session.cameraMoves.cancel();
    await session.cameraMoves.end();
    expect(fake.made).toEqual([]);
    expect([session.document.unsaved.value, session.document.dragging.value]).toEqual([[], false]);
  });

  it("sets keys where it is to, and where the camera stands", async () => {
    const { fake, session, read } = await held();
    read();
    session.cameraMoves.isKeyed.value = true;
    session.cameraMoves.move("dolly", [0.5, 0]);
    await session.cameraMoves.end();
    session.cameraMoves.isKeyed.value = false;
    await session.cameraMoves.key();
    const keyed = { ...DOLLIED, keyed: true };
    expect(sent(fake.made)).toEqual([[keyed], [{ ...keyed, positionM: [0, 1, 0] }]]);
    expect(session.cameraMoves.isKeyed.value).toBe(false);
  });

  it("tells why it does nothing when the service refuses", async () => {
    const { fake, session, failed, read } = await held();
    fake.failing = "moveCamera";
    read();
    session.cameraMoves.move("orbit", [0.5, 0]);
    await session.cameraMoves.end();
    expect(failed).toHaveLength(1);
    expect(session.document.unsaved.value).toEqual([]);
  });
});

it("needs the camera unchanged for a copy or a move of it", () => {
  expect(addressOf({ type: "duplicateCamera", name: "hero" })).toBe(CAMERA);
  expect(addressOf({ type: "moveCamera", positionM: [0, 0, 0], ahead: [0, 0, -1], up: [0, 1, 0], time: 1, keyed: true })).toBe(CAMERA); // prettier-ignore
});
