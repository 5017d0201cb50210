import { signal } from "@preact/signals";
import { MidiInput, type MidiAccess, type MidiPort } from "@/editor/midi_input";
import { PadInput } from "@/editor/pad_input";
import type { Pad, Way } from "@/model/gamepad";

function port(): MidiPort {
  return { onmidimessage: null };
}

describe("a MIDI device", () => {
  const connected = async (
    kept = signal(""),
  ): Promise<{ midi: MidiInput; turns: number[]; send: (...bytes: number[]) => void; access: MidiAccess }> => {
    const [ports, turns] = [[port()], [] as number[]];
    const access: MidiAccess = { inputs: { values: () => ports }, onstatechange: null };
    const midi = new MidiInput(
      () => Promise.resolve(access),
      kept,
      (turn) => turns.push(turn),
    );
    await midi.connect();
    return { midi, turns, send: (...bytes) => ports[0]?.onmidimessage?.({ data: bytes }), access };
  };

  it("turns the ring by the controller that is turned first", async () => {
    const kept = signal("");
    const { midi, turns, send } = await connected(kept);
    expect(midi.state.value).toBe("learning");
    send(0x90, 60, 100);
    send(0xb0, 7, 127);
    send(0xb0, 8, 0);
    send(0xb0, 7, 0);
    expect([midi.state.value, turns, kept.value]).toEqual(["on", [1, 0], "0 7"]);
  });

  it("keeps its controller, and learns another one", async () => {
    const { midi, turns, send } = await connected(signal("0 7"));
    send(0xb0, 8, 127);
    expect([midi.state.value, turns]).toEqual(["on", []]);
    midi.learn();
    send(0xb0, 8, 127);
    expect(turns).toEqual([1]);
  });

  it("is left alone once it is closed", async () => {
    const { midi, turns, send, access } = await connected();
    midi.close();
    send(0xb0, 7, 127);
    expect([turns, access.onstatechange, midi.state.value]).toEqual([[], null, "off"]);
  });

  it("may be refused", async () => {
    const midi = new MidiInput(
      () => Promise.reject(new Error("no")),
      signal(""),
      () => undefined,
    );
    await midi.connect();
    expect(midi.state.value).toBe("refused");
    expect(new MidiInput(null, signal(""), () => undefined).isPossible).toBe(false);
  });
});

it("a MIDI device is left alone where it is closed before the person lets it in", async () => {
  const ports = [port()];
  const access: MidiAccess = { inputs: { values: () => ports }, onstatechange: null };
  let letIn: (access: MidiAccess) => void = () => undefined;
  const asked = new Promise<MidiAccess>((resolve) => (letIn = resolve));
  const midi = new MidiInput(
    () => asked,
    signal("0 7"),
    () => undefined,
  );
  const connected = midi.connect();
  midi.close();
  letIn(access);
  await connected;
  expect([ports[0]?.onmidimessage, access.onstatechange, midi.state.value]).toEqual([null, null, "off"]);
  await midi.connect();
  expect([ports[0]?.onmidimessage === null, midi.state.value]).toEqual([false, "on"]);
});

let frames: FrameRequestCallback[] = [];
let now = 0;
const pass = (): void => {
  now += 20;
  const due = frames;
  frames = [];
  for (const act of due) act(now);
};

beforeEach(() => {
  [frames, now] = [[], 0];
  vi.spyOn(performance, "now").mockImplementation(() => now);
  vi.stubGlobal("requestAnimationFrame", (act: FrameRequestCallback) => frames.push(act));
  vi.stubGlobal("cancelAnimationFrame", () => (frames = []));
});

afterEach(() => {
  vi.restoreAllMocks();
  vi.unstubAllGlobals();
});

const made = (way: Way): { input: PadInput; pad: { axes: number[] } & Pad; done: string[] } => {
  const [pad, done] = [{ axes: [0, 0], buttons: [] }, [] as string[]];
  const ring = {
    easeTo: (turn: number) => done.push(`to ${turn.toFixed(2)}`),
    turnBy: (by: number) => done.push(`by ${by.toFixed(3)}`),
  };
  return { input: new PadInput(() => [null, pad], signal(""), signal(way), ring), pad, done };
};

describe("a game controller", () => {
  it("is the place of the ring, once a stick was moved", () => {
    const { input, pad, done } = made("absolute");
    input.connect();
    pass();
    pad.axes[1] = 1;
    pass();
    pass(); // it lies still
    pad.axes[1] = 0;
    pass();
    expect([input.isThere.value, input.lever, done]).toEqual([true, { kind: "axis", index: 1 }, ["to 0.50"]]);
  });

  it("is the speed of the ring", () => {
    const { input, pad, done } = made("rate");
    input.connect();
    pass();
    pad.axes[0] = -1;
    pass();
    pass();
    pad.axes[0] = 0.05;
    pass();
    input.close();
    pass();
    expect(done).toEqual(["by -0.010"]);
  });
});
