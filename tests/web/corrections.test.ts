import { signal } from "@preact/signals";
import { Session } from "@/editor/session";
import type { Drag } from "@/editor/drag";
import { setKey, type ValueOwner } from "@/model/key_lanes";
import type { Key } from "@/model/keys";
import type { FilmSettings } from "@/model/photography";
import type { FocusSettings } from "@/model/shot";
import { FakeService, SHOT, turn } from "./fake_service";
import { point } from "./points";

const KEYS: Key[] = Array.from({ length: 60 }, (_, i) => ({ time: i + 1, value: 4, interpolation: "linear" }));

/** A session whose f-number has a key on each frame, at frame 30. */
async function opened(): Promise<{ fake: FakeService; session: Session }> {
  const fake = new FakeService();
  fake.keyed = { fStop: KEYS };
  const rights = { noEdits: signal(null), noPictures: signal(null) };
  const session = new Session(fake.service, SHOT, "/cam", 30, () => undefined, rights);
  await turn();
  return { fake, session };
}

async function setStop(session: Session, value: number): Promise<void> {
  const readout = session.document.readout.value;
  if (!readout) throw new Error("There is no readout.");
  session.dragLens("f-number", "fStop", readout).commit(value);
  await turn();
}

beforeEach(() => {
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

it("a value on a dense curve bends it, and its width can be changed in the same step of undo", async () => {
  const { fake, session } = await opened();
  await setStop(session, 8);
  expect(fake.made[0]).toHaveLength(23);
  expect(session.corrections.last.value).toMatchObject({ label: "f-number", time: 30, width: 12 });
  await session.corrections.widen(5);
  expect(fake.made[1]).toHaveLength(23); // 9 are bent, and 14 go back
  expect(session.corrections.last.value).toMatchObject({ width: 5 });
  expect([fake.gestures[0] !== "", fake.gestures[1] === fake.gestures[0]]).toEqual([true, true]);
  await setStop(session, 9);
  expect(fake.gestures[2]).not.toBe(fake.gestures[0]);
  expect(fake.made[2]).toHaveLength(9);
});

it("a width after another edit is for the next correction alone", async () => {
  const { fake, session } = await opened();
  await setStop(session, 8);
  const other = session.document.edit("other", [{ type: "setFocus", values: { lagS: 1 } }]);
  await session.corrections.widen(5);
  await other;
  expect(fake.made).toHaveLength(2);
  expect([session.corrections.last.value, session.corrections.width.value]).toEqual([null, 5]);
});

it("a correction while another one is under way is of what that leaves", async () => {
  const { fake, session } = await opened();
  const readout = session.document.readout.value;
  if (!readout) throw new Error("There is no readout.");
  session.dragLens("f-number", "fStop", readout).commit(8);
  fake.keyed = { fStop: KEYS.map((key) => (key.time === 28 ? { ...key, value: 7 } : key)) };
  session.playhead.goTo(32);
  session.dragLens("f-number", "fStop", readout).commit(4);
  await session.document.idle();
  expect(fake.made[1]?.find((change) => "key" in change && change.key.time === 28)).toMatchObject({
    key: { value: 7 },
  });
});

it("a correction that is refused leaves nothing to widen", async () => {
  const { fake, session } = await opened();
  fake.failing = "keySetting";
  await setStop(session, 8);
  expect(session.corrections.last.value).toBeNull();
  await session.corrections.widen(5);
  expect(fake.made).toEqual([]);
});

it.each<[string, ValueOwner, (session: Session) => Drag<number>]>([
  [
    "a tilt",
    { setting: "tiltDeg" },
    (session) => session.dragFocus("tilt", "tiltDeg", { keys: { tiltDeg: KEYS } } as unknown as FocusSettings),
  ],
  [
    "a film setting",
    { setting: "grainAmount" },
    ({ photography }) =>
      photography.dragFilm("grainAmount", "grainAmount", { keys: { grainAmount: KEYS } } as unknown as FilmSettings),
  ],
  [
    "a point’s weight",
    { point: "eye", attribute: "weight" },
    (session) =>
      session.dragPoint(
        "weight",
        point("eye", { weight: Object.fromEntries(KEYS.map(({ time, value }) => [time, value])) }),
        "weight",
      ),
  ],
])("a value on the dense curve of %s bends it", async (_, owner, drag) => {
  const { fake, session } = await opened();
  drag(session).commit(8);
  await turn();
  expect(fake.made[0]).toHaveLength(23);
  expect(fake.made[0]).toEqual(
    fake.made[0]?.map((change) => ("key" in change ? setKey(owner, change.key as Key) : null)),
  );
  expect(session.corrections.last.value).toMatchObject({ owner, time: 30, width: 12 });
});
