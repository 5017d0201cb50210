import {
  chromaOf,
  figuresOf,
  histogramOf,
  MOST_COLUMNS,
  outlineOf,
  painted,
  peakOf,
  planesOf,
  SKIN_DEG,
  TARGETS,
  vectorscopeOf,
  waveformOf,
} from "@/model/scopes";

type Rgb = readonly [number, number, number];

function picture(...pixels: readonly Rgb[]): Uint8ClampedArray {
  return Uint8ClampedArray.from(pixels.flatMap((rgb) => [...rgb, 255]));
}

/** A row of greys, from black to white. */
const RAMP = picture(...Array.from({ length: 256 }, (_, level): Rgb => [level, level, level]));

/** Places with a count, and the counts. */
function found(counts: Uint32Array): [number, number][] {
  return [...counts.entries()].filter(([, count]) => count > 0);
}

describe("a histogram", () => {
  it("has one pixel of a ramp at each level of each channel", () => {
    const planes = planesOf(RAMP);
    for (const plane of Object.values(planes)) expect(histogramOf(plane)).toEqual(new Uint32Array(256).fill(1));
  });

  it("has the luma of Rec. 709", () => {
    const { luma } = planesOf(picture([255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]));
    expect([...luma]).toEqual([0.2126, 0.7152, 0.0722, 1].map((weight) => Math.round(255 * weight)));
  });

  it("is drawn up to its peak between the ends, with a step for each level", () => {
    const counts = histogramOf(Uint8Array.from([0, 0, 0, 7, 7, 255]));
    expect(peakOf([counts])).toBe(2);
    expect(outlineOf(Uint32Array.from([3, 0, 2]))).toBe("M0 0V3h1V0h1V2h1V0Z");
  });
});

describe("a waveform", () => {
  it("has each level of a ramp in its column, white on top", () => {
    const { width, height, counts } = waveformOf(planesOf(RAMP).luma, 256);
    expect([width, height]).toEqual([256, 256]);
    expect(found(counts)).toEqual(
      Array.from({ length: 256 }, (_, row) => [row * 256 + 255 - row, 1] as [number, number]),
    );
  });

  it("counts every pixel of a wider picture", () => {
    const wide = 3 * MOST_COLUMNS;
    const { width, counts } = waveformOf(new Uint8Array(2 * wide).fill(255), wide);
    expect(width).toBe(MOST_COLUMNS);
    expect(counts.subarray(0, width)).toEqual(new Uint32Array(width).fill(6));
    expect(counts.subarray(width).every((count) => count === 0)).toBe(true);
  });
});

describe("a vectorscope", () => {
  it("has all greys in its middle", () => {
    expect(found(vectorscopeOf(planesOf(RAMP)).counts)).toEqual([[127 * 256 + 128, 256]]);
  });

  it("has full blue at the right edge and full red at the top", () => {
    const places = [[0, 0, 255] as const, [255, 0, 0] as const].map((rgb) =>
      found(vectorscopeOf(planesOf(picture(rgb))).counts).map(([at]) => [at % 256, Math.floor(at / 256)]),
    );
    expect(places).toEqual([[[255, 127 + 12]], [[128 - 29, 0]]]);
  });

  it("has opposite colours opposite of each other, in the order of hues", () => {
    const [red, yellow, green, cyan, blue, magenta] = TARGETS.map(({ chroma }) => chroma);
    for (const [one, other] of [
      [red, cyan],
      [yellow, blue],
      [green, magenta],
    ] as const) {
      expect((one?.[0] ?? 1) + (other?.[0] ?? 1)).toBeCloseTo(0, 9);
      expect((one?.[1] ?? 1) + (other?.[1] ?? 1)).toBeCloseTo(0, 9);
    }
    expect(TARGETS.map(({ name }) => name)).toEqual(["R", "Yl", "G", "Cy", "B", "Mg"]);
    expect(blue?.[0]).toBeCloseTo(0.75 * 127.5, 9);
    expect(red?.[1]).toBeCloseTo(0.75 * 127.5, 9);
  });

  it("has skin near its line", () => {
    for (const [r, g, b] of [
      [224, 172, 138],
      [141, 85, 54],
    ] as const) {
      const [cb, cr] = chromaOf(r, g, b);
      expect(Math.abs((Math.atan2(cr, cb) * 180) / Math.PI - SKIN_DEG)).toBeLessThan(8);
    }
  });
});

describe("a density", () => {
  it("is drawn by the root of its counts, up to the full one", () => {
    const counts = Uint32Array.from([0, 1, 4, 16]);
    const rgba = painted({ width: 4, height: 1, counts, full: 4 }, [255, 100, 0]);
    expect([...rgba]).toEqual([0, 0, 0, 255, 128, 50, 0, 255, 255, 100, 0, 255, 255, 100, 0, 255]);
  });
});

describe("figures of a picture", () => {
  it("are its mean luma and its clipped pixels", () => {
    const { mean, low, high } = figuresOf(planesOf(picture([0, 0, 0], [255, 255, 255], [255, 0, 9], [51, 51, 51])));
    expect(mean).toBeCloseTo((1 + 0.2126 + (0.0722 * 9) / 255 + 0.2) / 4, 12);
    expect([low, high]).toEqual([0.5, 0.5]);
  });
});
