import { groupNames, groupsOf } from "@/model/groups";
import { point } from "./points";

const [PIP, MARA, LAMP] = [{ ...point("pip"), group: "cast" }, { ...point("mara"), group: "cast" }, point("lamp")];
const SIGN = { ...point("sign"), group: "set" };

describe("groups of points", () => {
  it("stand in the order of their first points, after those of none", () => {
    expect(groupsOf([SIGN, PIP, LAMP, MARA])).toEqual([
      { name: "", points: [LAMP] },
      { name: "set", points: [SIGN] },
      { name: "cast", points: [PIP, MARA] },
    ]);
    expect(groupNames([SIGN, PIP, LAMP])).toEqual(["set", "cast"]);
  });

  it("are none without points", () => {
    expect(groupsOf([])).toEqual([]);
    expect(groupsOf([PIP]).map(({ name }) => name)).toEqual(["cast"]);
  });
});
