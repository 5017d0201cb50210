import { Chosen } from "@/view/controls/chosen";

describe("a choice", () => {
  it("shows until its edit is made and what came of it was read", async () => {
    const chosen = new Chosen<string>();
    const edit = Promise.resolve(true);
    chosen.choose("manual", edit, 5);
    chosen.settle(true); // what is there is of before the edit
    expect(chosen.choice.value).toMatchObject({ value: "manual", at: 5 });
    await edit;
    chosen.settle(false);
    expect(chosen.choice.value?.value).toBe("manual");
    chosen.settle(true);
    expect(chosen.choice.value).toBeNull();
  });

  it("goes where its edit fails", async () => {
    const chosen = new Chosen<string>();
    const edit = Promise.reject(new Error("refused"));
    chosen.choose("manual", edit);
    await edit.catch(() => undefined);
    chosen.settle(true);
    expect(chosen.choice.value).toBeNull();
  });

  it("takes the place of one whose edit is under way", async () => {
    const chosen = new Chosen<string>();
    const first = Promise.resolve();
    chosen.choose("manual", first);
    chosen.choose("points", new Promise(() => undefined));
    await first;
    chosen.settle(true);
    expect(chosen.choice.value?.value).toBe("points");
  });
});
