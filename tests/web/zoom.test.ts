import { Zoom } from "@/editor/zoom";
import { wantedQuality } from "@/model/quality";
import { fitScale, movedBy, placed, scaledTo, withPlace, type Placing, type Room } from "@/model/zoom";

const ROOM: Room = { width: 800, height: 600, ratio: 2, aspect: 16 / 9, deliveredPx: 1920 };

/** Where a place of the picture is in its room, CSS px. */
function onScreen(placing: Placing | null, [x, y]: readonly [number, number]): [number, number] {
  const { left, top, width, height } = placed(ROOM, placing);
  return [left + x * width, top + y * height];
}

describe("an enlarged picture", () => {
  it("is shown as a whole at first", () => {
    expect(placed(ROOM, null)).toEqual({ left: 0, top: 75, width: 800, height: 450 });
    expect(fitScale(ROOM)).toBeCloseTo(1600 / 1920, 6);
  });

  it("at 1:1 has a device pixel for each pixel of the delivered picture", () => {
    const box = placed(ROOM, scaledTo(ROOM, null, 1, [0.5, 0.5]));
    expect([box.width * ROOM.ratio, box.height * ROOM.ratio]).toEqual([1920, 1080]);
    expect(wantedQuality({ width: 4096, height: 2304, isDelivered: true })).toMatchObject({
      width: 4096,
      height: 2304,
      rays: 100,
    });
  });

  it("keeps the place under the pointer where it is", () => {
    const [place, once] = [[0.3, 0.6] as const, scaledTo(ROOM, null, 4, [0.3, 0.6])];
    for (const [axis, at] of onScreen(once, place).entries())
      expect(at).toBeCloseTo(onScreen(null, place)[axis] ?? 0, 0);
    const twice = scaledTo(ROOM, once, 8, place);
    for (const [axis, at] of onScreen(twice, place).entries())
      expect(at).toBeCloseTo(onScreen(once, place)[axis] ?? 0, 0);
  });

  it("covers its room, however far it is moved", () => {
    const placing: Placing = { scale: 4, centre: [0.5, 0.5] };
    const far = placed(ROOM, movedBy(ROOM, placing, 1e5, -1e5));
    expect(far.left).toBe(0);
    expect(far.top + far.height).toBe(600);
    const narrow = placed({ ...ROOM, deliveredPx: 1280 }, scaledTo({ ...ROOM, deliveredPx: 1280 }, null, 1, [0, 0]));
    expect(narrow).toEqual({ left: 80, top: 120, width: 640, height: 360 });
  });

  it("becomes the whole picture again below its size, and never larger than a bound", () => {
    expect(scaledTo(ROOM, { scale: 1, centre: [0.5, 0.5] }, 0.5, [0.5, 0.5])).toBeNull();
    expect(scaledTo(ROOM, null, 1e6, [0.5, 0.5])?.scale).toBe(32);
  });

  it("brings a place into view by the least that it takes", () => {
    const placing: Placing = { scale: 4, centre: [0.5, 0.5] };
    expect(withPlace(ROOM, placing, [0.5, 0.5])).toEqual(placing);
    const [x, y] = onScreen(withPlace(ROOM, placing, [0.9, 0.5]), [0.9, 0.5]);
    expect(x).toBeCloseTo(800, 0);
    expect(y).toBeCloseTo(300, 0);
  });
});

describe("the zoom of a shot", () => {
  it("goes to 1:1 and back, by steps, and moves only what is enlarged", () => {
    const zoom = new Zoom();
    zoom.toggle(null); // before the room is known
    expect(zoom.scale.value).toBeNull();
    zoom.room = ROOM;
    zoom.move(10, 0);
    zoom.reveal([0, 0]);
    expect(zoom.placing.value).toBeNull();
    zoom.toggle([0.2, 0.2]);
    expect(zoom.scale.value).toBe(1);
    zoom.step(1, null);
    expect(zoom.scale.value).toBeCloseTo(Math.SQRT2, 6);
    zoom.move(50, 0);
    zoom.toggle(null);
    expect(zoom.placing.value).toBeNull();
  });
});
