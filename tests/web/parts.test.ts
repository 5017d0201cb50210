import { holderOf, partsOf } from "@/model/parts";
import { point } from "./points";

const CAMERAS = ["/World/cam"];

function on(path: string, part = ""): ReturnType<typeof point> {
  const plain = point("pip");
  return { ...plain, anchor: { ...plain.anchor, target: [path] }, part };
}

describe("the parts that a point can follow", () => {
  it("are its target and what that is in, nearest first, without the root of the scene", () => {
    expect(partsOf(on("/World/Cast/Mara/Body/Head/VisorGlow"), CAMERAS)).toEqual([
      "/World/Cast/Mara/Body/Head/VisorGlow",
      "/World/Cast/Mara/Body/Head",
      "/World/Cast/Mara/Body",
      "/World/Cast/Mara",
      "/World/Cast",
    ]);
  });

  it("have the root where it is all there is", () => {
    expect(partsOf(on("/World/near"), CAMERAS)).toEqual(["/World/near", "/World"]);
    expect(partsOf(on("/mesh"), CAMERAS)).toEqual(["/mesh"]);
  });

  it("have the root where it is a thing beside the cameras", () => {
    expect(partsOf(on("/Mara/Body/Head"), CAMERAS)).toEqual(["/Mara/Body/Head", "/Mara/Body", "/Mara"]);
  });

  it("have a part that is elsewhere last", () => {
    expect(partsOf(on("/World/near", "/Other/thing"), CAMERAS)).toEqual(["/World/near", "/World", "/Other/thing"]);
    expect(partsOf(on("/World/near", "/World"), CAMERAS)).toEqual(["/World/near", "/World"]);
  });

  it("name what the point is on", () => {
    expect(holderOf(on("/World/Mara/Head"))).toBe("Head");
    expect(holderOf(on("/World/Mara/Head", "/World/Mara"))).toBe("Mara");
  });
});
