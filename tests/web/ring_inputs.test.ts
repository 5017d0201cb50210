import { leverAt, movedLever, rateOf, turnOf, type Pad } from "@/model/gamepad";
import { controlChange, ControllerReader, learnedFrom } from "@/model/midi";

describe("a message of a MIDI controller", () => {
  it.each<[string, number[], object | null]>([
    ["a control change", [0xb0, 7, 100], { channel: 0, number: 7, value: 100 }],
    ["one of the last channel", [0xbf, 127, 0], { channel: 15, number: 127, value: 0 }],
    ["a note", [0x90, 60, 100], null],
    ["a clock", [0xf8], null],
    ["a part of one", [0xb0, 7], null],
    ["no such value", [0xb0, 7, 200], null],
    ["nothing", [], null],
  ])("that is %s is read", (_name, bytes, expected) => {
    expect(controlChange(bytes)).toEqual(expected);
  });

  it("of 7 bits goes from 0 to 1", () => {
    const reader = new ControllerReader({ channel: 0, number: 7 });
    expect([0, 127].map((value) => reader.read([0xb0, 7, value]))).toEqual([0, 1]);
  });

  it("of 14 bits is as fine", () => {
    const reader = new ControllerReader({ channel: 2, number: 1 });
    expect(reader.read([0xb2, 33, 64])).toBeNull();
    expect(reader.read([0xb2, 1, 64])).toBeCloseTo((64 * 128 + 64) / 16_383, 9);
    expect(reader.read([0xb2, 33, 65])).toBeCloseTo((64 * 128 + 65) / 16_383, 9);
    reader.read([0xb2, 1, 127]);
    expect(reader.read([0xb2, 33, 127])).toBe(1);
  });

  it("of another controller or channel is none of its", () => {
    const reader = new ControllerReader({ channel: 0, number: 70 });
    expect(reader.read([0xb0, 71, 3])).toBeNull();
    expect(reader.read([0xb1, 70, 3])).toBeNull();
    expect(reader.read([0xb0, 102, 3])).toBeNull(); // only those below 32 have a finer part
  });

  it("tells which controller is turned", () => {
    const first = learnedFrom([0xb1, 4, 9], null);
    expect(first).toEqual({ channel: 1, number: 4 });
    expect(learnedFrom([0xb1, 36, 9], first)).toBe(first);
    expect(learnedFrom([0xb1, 36, 9], null)).toEqual({ channel: 1, number: 36 });
    expect(learnedFrom([0x90, 60, 9], first)).toBeNull();
  });
});

function pad(axes: readonly number[], values: readonly number[] = []): Pad {
  return { axes, buttons: values.map((value) => ({ value })) };
}

describe("a game controller", () => {
  it("is where its lever is", () => {
    expect([-1, 0, 1].map((at) => turnOf({ kind: "axis", index: 0 }, at))).toEqual([0, 0.5, 1]);
    expect([0, 0.25, 1].map((at) => turnOf({ kind: "button", index: 0 }, at))).toEqual([0, 0.25, 1]);
    expect(leverAt(pad([0.5], [0.2]), { kind: "button", index: 0 })).toBe(0.2);
    expect(leverAt(pad([0.5]), { kind: "axis", index: 3 })).toBeNull();
  });

  it("turns the ring at a speed, and rests near the middle", () => {
    expect([-0.1, 0, 0.1].map(rateOf).map(Math.abs)).toEqual([0, 0, 0]);
    expect([-1, 1].map(rateOf)).toEqual([-1, 1]);
    expect(rateOf(0.5)).toBeLessThan(0.25);
  });

  it("tells which lever is moved", () => {
    expect(movedLever(pad([0, 0], [0]), pad([0.2, -0.9], [0]))).toEqual({ kind: "axis", index: 1 });
    expect(movedLever(pad([0], [0, 0]), pad([0], [0, 0.8]))).toEqual({ kind: "button", index: 1 });
    expect(movedLever(pad([-1], [1]), pad([-0.9], [1]))).toBeNull();
  });
});
