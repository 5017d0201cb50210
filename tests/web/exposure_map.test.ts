import { deflateSync } from "node:zlib";
import { bandOf, falseColour, zebra, type ExposureMap } from "@/model/exposure_map";
import { decodeExposureMap } from "@/net/exposure_map";

/** A map of 2 by 2 pixels as a service encodes it: 0, 2.5 and -1 stops, and no light. */
function encoded(): ArrayBuffer {
  const head = new TextEncoder().encode(JSON.stringify({ width: 2, height: 2, stepsPerStop: 256 }));
  const numbers = [0, 640, -256, -32768].map((number) => number & 0xffff);
  const steps = numbers.map((number, at) => (number - (at % 2 > 0 ? (numbers[at - 1] ?? 0) : 0)) & 0xffff);
  const body = deflateSync(Uint8Array.from([...steps.map((step) => step & 255), ...steps.map((step) => step >> 8)]));
  const bytes = new Uint8Array(4 + head.length + body.length);
  new DataView(bytes.buffer).setUint32(0, head.length);
  bytes.set(head, 4);
  bytes.set(body, 4 + head.length);
  return bytes.buffer;
}

describe("an exposure map", () => {
  it("is decoded to stops", async () => {
    expect(await decodeExposureMap(encoded())).toEqual({
      width: 2,
      height: 2,
      stops: Float32Array.from([0, 2.5, -1, -Infinity]),
    });
  });

  it("is refused where it is cut short", async () => {
    const head = new TextEncoder().encode(JSON.stringify({ width: 9, height: 9, stepsPerStop: 256 }));
    const body = deflateSync(new Uint8Array(8));
    const bytes = Uint8Array.from([0, 0, 0, head.length, ...head, ...body]);
    await expect(decodeExposureMap(bytes.buffer)).rejects.toThrow("not of the size");
  });
});

const MAP: ExposureMap = { width: 4, height: 1, stops: Float32Array.from([-Infinity, 0.49, 2.49, 2.5]) };

describe("exposure over the picture", () => {
  it("has a colour for each stop, from half a stop below to half above", () => {
    expect(bandOf(0)).toEqual(bandOf(-0.49));
    expect(bandOf(0.51)).toEqual(bandOf(1));
    expect(bandOf(1)).not.toEqual(bandOf(0));
    expect(bandOf(40)).toEqual(bandOf(6));
    const colours = falseColour(MAP);
    expect([...colours.slice(0, 4)]).toEqual([...bandOf(-6), 255]);
    expect([...colours.slice(4, 8)]).toEqual([...bandOf(0), 255]);
  });

  it("has stripes from the stated stops on, and nothing below", () => {
    const stripes = zebra(MAP, 2.5, 16, 8);
    const covered = Array.from(
      { length: 16 },
      (_, column) =>
        Array.from({ length: 8 }, (__, row) => stripes[4 * (row * 16 + column) + 3] ?? 0).filter(Boolean).length,
    );
    expect(covered).toEqual([...Array<number>(12).fill(0), ...Array<number>(4).fill(4)]);
  });
});
