/** The ring is recorded while the shot plays by a clock that the test turns. */

import { KeptPulls } from "@/editor/kept_pulls";
import type { RingDesk } from "@/editor/ring_desk";
import { endOf, samplesOf } from "@/model/take";
import { SHOT } from "./fake_service";
import { opened, pass, read, Store, turnsClock } from "./recorded_desk";

turnsClock();

describe("the recorder", () => {
  it("begins when the ring is turned, and ends with the shot", async () => {
    const { desk } = await opened();
    desk.record();
    pass(1);
    expect(desk.recorder.state.value).toBe("armed");
    pass(1, () => {
      desk.ring.turnBy(-0.002);
    });
    expect(desk.recorder.state.value).toBe("recording");
    pass(3);
    const take = desk.take.value;
    expect(desk.recorder.state.value).toBe("off");
    expect(take && [take.start, endOf(take)]).toEqual([25, 96]);
    const distances = take ? samplesOf(take).map(({ distanceM }) => distanceM) : [];
    expect(distances[0]).toBeCloseTo(3, 1);
    expect(distances.at(-1)).toBeCloseTo(0.5 / (0.5 / 3 + 0.12), 3);
    expect(desk.simplified.value?.keys.length).toBeLessThanOrEqual(4);
  });

  it("records from the punch-in to the punch-out, after a second before it", async () => {
    const { session, desk } = await opened();
    desk.punch({ punchIn: 40 });
    desk.punch({ punchOut: 60 });
    desk.record();
    expect(session.playhead.time.value).toBe(16);
    pass(3, () => {
      desk.ring.turnBy(0.0005);
    });
    expect(desk.recorder.state.value).toBe("off");
    expect(desk.take.value).toMatchObject({ start: 40, nearness: { length: 21 } });
    expect(session.playhead.playing.value).toBe(false);
    expect(session.playhead.time.value).toBe(60);
  });
});

describe("a recording", () => {
  it("ends where the person pauses, and makes no take of what was not begun", async () => {
    const { session, desk } = await opened();
    desk.record();
    pass(0.5);
    session.playhead.pause();
    expect([desk.recorder.state.value, desk.notes.value.takes]).toEqual(["off", []]);
    desk.record();
    pass(1, () => {
      desk.ring.turnBy(0.001);
    });
    desk.record();
    expect(desk.notes.value.takes).toHaveLength(1);
  });

  it("plays slower where that is chosen", async () => {
    const { desk } = await opened();
    desk.recorder.speed.value = 0.5;
    desk.record();
    pass(2, () => {
      desk.ring.turnBy(0.001);
    });
    desk.record();
    const take = desk.take.value;
    expect(take && endOf(take)).toBe(24);
  });
});

describe("takes and marks", () => {
  it("are there again when the shot is opened again", async () => {
    const store = new Store();
    const { desk } = await opened(store);
    desk.setMark();
    desk.setMark(4);
    desk.record();
    pass(1, () => {
      desk.ring.turnBy(0.001);
    });
    desk.record();
    const again = (await opened(store)).desk;
    expect(again.notes.value).toEqual(desk.notes.value);
    expect(again.take.value).toEqual(desk.take.value);
    expect(again.notes.value.marks.filter((mark) => mark !== null)).toHaveLength(2);
    expect(new KeptPulls(store, "somebody else").find(SHOT.id)).toBeNull();
  });

  it("are tried again in place of the last one, or deleted", async () => {
    const { desk } = await opened();
    for (let taken = 0; taken < 2; taken += 1) {
      desk.record();
      pass(0.5, () => {
        desk.ring.turnBy(0.001);
      });
      desk.record();
    }
    expect(desk.take.value?.number).toBe(2);
    desk.again();
    expect(desk.recorder.state.value).toBe("armed");
    desk.record();
    expect(desk.notes.value.takes.map(({ number }) => number)).toEqual([1]);
    desk.removeTake(1);
    expect(desk.take.value).toBeNull();
  });

  it("a take becomes the focus in one step", async () => {
    const { fake, session, desk } = await opened();
    fake.keyed = { focusDistanceM: [{ time: 1, value: 3, interpolation: "linear" }] };
    session.document.refresh();
    await read();
    desk.record();
    pass(1, () => {
      desk.ring.turnBy(0.001);
    });
    desk.record();
    await read();
    expect(await desk.apply()).toBe(true);
    expect(fake.made).toHaveLength(1);
    expect(fake.made[0]?.every(({ type }) => type === "keySetting" || type === "unkeySetting")).toBe(true);
  });
});

/** Records a short take. */
function record(desk: RingDesk): void {
  desk.record();
  pass(0.5, () => {
    desk.ring.turnBy(0.001);
  });
  desk.record();
}

describe("takes and marks of a shot in two windows", () => {
  it("are those of both", async () => {
    const store = new Store();
    const [{ desk: one }, { desk: other }] = [await opened(store), await opened(store)];
    record(one);
    other.setMark(2);
    other.punch({ punchOut: 50 });
    record(other);
    expect(other.chosen.value).toBe(2);
    one.setMark(4);
    const notes = one.notes.value;
    expect(notes).toEqual(new KeptPulls(store, "me").find(SHOT.id));
    expect(notes.takes.map(({ number }) => number)).toEqual([1, 2]);
    expect([notes.marks.map((mark) => mark !== null).indexOf(true), notes.punchOut]).toEqual([1, 50]);
    one.removeTake(2);
    record(other);
    expect(other.notes.value.takes.map(({ number }) => number)).toEqual([1, 3]);
  });
});

describe("takes and marks without room", () => {
  it("last as long as the shot is open, which the person is told once", async () => {
    const store = new Store();
    const said: string[] = [];
    const { desk } = await opened(store, (error) => said.push((error as Error).message));
    record(desk);
    store.isFull = true;
    record(desk);
    desk.setMark(1);
    expect(said).toEqual(["The browser has no room to keep takes and marks."]);
    expect(desk.notes.value.takes).toHaveLength(2);
    store.isFull = false;
    desk.removeTake(1);
    expect(new KeptPulls(store, "me").find(SHOT.id)).toEqual(desk.notes.value);
    expect(desk.notes.value).toMatchObject({ takes: [{ number: 2 }] });
  });
});

describe("the ring", () => {
  it("shows its focus in the picture while it is turned, and gives that back", async () => {
    const { session, desk } = await opened();
    desk.ring.turnBy(-0.1);
    expect(session.document.unsaved.value).toMatchObject([{ values: { mode: "manual" } }, { type: "setCamera" }]);
    session.playhead.goTo(20);
    expect(session.document.unsaved.value).toEqual([]);
    expect(desk.ring.isByHand.value).toBe(false);
    desk.choices.follows.value = "off";
    desk.ring.turnBy(-0.1);
    expect(session.document.unsaved.value).toEqual([]);
  });

  it("eases to where a coarse device has it", async () => {
    const { desk } = await opened();
    desk.ring.easeTo(0.2);
    pass(0.03);
    expect(desk.ring.turn.value).toBeGreaterThan(0.25);
    pass(1);
    expect(desk.ring.turn.value).toBe(0.2);
  });

  it("is drawn by marks where that is wished, and comes past them", async () => {
    const { desk } = await opened();
    desk.ring.easeTo(0.5);
    pass(1);
    desk.setMark(1);
    desk.choices.snaps.value = "on";
    desk.ring.turnBy(0.004);
    expect(desk.ring.turn.value).toBeLessThan(0.501);
    desk.ring.turnBy(0.016);
    expect(desk.ring.turn.value).toBeCloseTo(0.52, 9);
  });
});
