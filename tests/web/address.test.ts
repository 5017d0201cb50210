import { signal } from "@preact/signals";
import type { Session } from "@/editor/session";
import { followAddress } from "@/view/address";

function openAt(time: number): Session {
  const playhead = { playing: signal(false), scrubbing: signal(false), time: signal(time) };
  return { document: { view: { shot: "demo", camera: "/a/cam" } }, playhead } as unknown as Session;
}

describe("the page's address", () => {
  it("says what is to be opened until a shot is open, and nothing once none is", () => {
    const session = signal<Session | null>(null);
    const written: string[] = [];
    followAddress({ session }, (address) => written.push(address));
    expect(written).toEqual([]);
    session.value = openAt(5);
    session.value = null;
    expect(written).toEqual(["?shot=demo&camera=/a/cam&time=5", "?"]);
  });

  it("goes with the time, and keeps still while it plays", () => {
    const session = openAt(5);
    const written: string[] = [];
    followAddress({ session: signal(session) }, (address) => written.push(address));
    session.playhead.playing.value = true;
    session.playhead.time.value = 6;
    session.playhead.time.value = 7;
    session.playhead.playing.value = false;
    expect(written.map((address) => new URLSearchParams(address).get("time"))).toEqual(["5", "7"]);
  });
});
