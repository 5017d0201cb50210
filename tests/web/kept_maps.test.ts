import { KeptMaps } from "@/editor/kept_maps";

function map(bytes: number, isExact = false): { data: ArrayBuffer; isExact: boolean } {
  return { data: new ArrayBuffer(bytes), isExact };
}

describe("kept focus maps", () => {
  it("are held to a budget, and the one unused for longest goes first", () => {
    const maps = new KeptMaps(100);
    maps.put(1, map(40));
    maps.put(2, map(40));
    maps.get(1);
    maps.put(3, map(40));
    expect([1, 2, 3].map((time) => maps.get(time) !== null)).toEqual([true, false, true]);
    maps.put(1, map(60));
    expect([1, 3].map((time) => maps.get(time)?.data.byteLength)).toEqual([60, 40]);
  });

  it("of previews do not take the place of exact ones", () => {
    const maps = new KeptMaps(100);
    maps.put(1, map(10));
    maps.put(1, map(20, true));
    maps.put(1, map(10));
    expect(maps.get(1)).toMatchObject({ isExact: true });
  });
});
