/** Recordings cover the frames that are played, and no others. */

import { KeptPulls } from "@/editor/kept_pulls";
import type { RingDesk } from "@/editor/ring_desk";
import type { Session } from "@/editor/session";
import { endOf } from "@/model/take";
import { SHOT } from "./fake_service";
import { opened, pass, Store, turnsClock, wait } from "./recorded_desk";

turnsClock();

function turning(desk: RingDesk): () => void {
  return () => {
    desk.ring.turnBy(0.0002);
  };
}

function spanOf({ take }: RingDesk): number[] | null {
  return take.value && [take.value.start, endOf(take.value)];
}

describe("a recording covers only what was played", () => {
  it.each<[string, (session: Session) => void]>([
    [
      "faster",
      ({ playhead }) => {
        playhead.shuttle(1);
      },
    ],
    [
      "backwards",
      ({ playhead }) => {
        playhead.shuttle(-1);
      },
    ],
    [
      "from its first frame",
      ({ playhead }) => {
        playhead.markFirst(playhead.time.value);
      },
    ],
    [
      "from a later frame",
      ({ playhead }) => {
        playhead.markFirst(60);
      },
    ],
    [
      "to an earlier frame",
      ({ playhead }) => {
        playhead.markLast(15);
      },
    ],
  ])("where it is played on %s", async (_name, change) => {
    const { session, desk } = await opened();
    desk.record();
    pass(0.81, turning(desk));
    change(session);
    pass(0.2, turning(desk));
    expect(desk.recorder.state.value).toBe("off");
    expect(spanOf(desk)).toEqual([1, 20]);
  });
});

describe("a recording covers what was played", () => {
  it.each<[string, number[], number[], number[]]>([
    ["to the last frame that is played", [10, 90], [1, 48], [10, 48]],
    ["from the first frame that is played", [10, 96], [40, 96], [40, 96]],
  ])("%s", async (_name, [punchIn = 0, punchOut = 0], [first = 0, last = 0], span) => {
    const { session, desk } = await opened();
    desk.punch({ punchIn, punchOut });
    session.playhead.markFirst(first);
    session.playhead.markLast(last);
    desk.record();
    pass(5, turning(desk));
    expect(desk.recorder.state.value).toBe("off");
    expect(spanOf(desk)).toEqual(span);
  });

  it.each(["loop", "pingPong", "once"] as const)("to its end, though the screen is slow (%s)", async (repeat) => {
    const { session, desk } = await opened();
    session.playhead.setRepeat(repeat);
    desk.record();
    for (let at = 0; at < 45; at += 1) {
      wait(90);
      turning(desk)();
      pass(1 / 60);
    }
    expect(desk.recorder.state.value).toBe("off");
    expect(spanOf(desk)).toEqual([expect.any(Number), 96]);
  });
});

describe("a recording of frames that are not played", () => {
  it("is refused, and tried again leaves the take", async () => {
    const said: string[] = [];
    const { session, desk } = await opened(new Store(), (error) => said.push((error as Error).message));
    desk.record();
    pass(1, () => {
      desk.ring.turnBy(0.001);
    });
    desk.record();
    desk.punch({ punchIn: 60 });
    session.playhead.markLast(48);
    desk.record();
    desk.again();
    expect([desk.recorder.state.value, session.playhead.playing.value]).toEqual(["off", false]);
    expect(said).toEqual(Array(2).fill("None of the frames to record is played."));
    expect(desk.notes.value.takes).toHaveLength(1);
  });

  it("ends once they are not", async () => {
    const said: string[] = [];
    const { session, desk } = await opened(new Store(), (error) => said.push((error as Error).message));
    desk.punch({ punchIn: 60 });
    desk.record();
    session.playhead.markLast(48);
    pass(0.1);
    expect([desk.recorder.state.value, said.length]).toEqual(["off", 1]);
  });
});

it("a recording under way is a take when the shot is closed", async () => {
  const store = new Store();
  const { session, desk } = await opened(store);
  desk.record();
  pass(1, () => {
    desk.ring.turnBy(0.001);
  });
  session.close();
  expect(new KeptPulls(store, "me").find(SHOT.id)?.takes).toMatchObject([{ start: 1 }]);
});
