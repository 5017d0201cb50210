import { Library } from "@/editor/library";
import type { ShotSummary, TrashedShot } from "@/model/shot";
import { errorOf } from "@/net/errors";
import type { Sending, Service } from "@/net/service";
import { SHOT } from "./fake_service";

/** A service with one shot and a trash, which keeps deleted shots or not. */
function shelf(keepsTrash = true): { library: Library; failed: unknown[]; quarantine: () => void } {
  let shots: readonly ShotSummary[] = [SHOT];
  let trash: readonly TrashedShot[] = [];
  const service: Partial<Service> = {
    shots: () => Promise.resolve([...shots]),
    trash: () => Promise.resolve(trash),
    removeShot: () => {
      shots = [];
      trash = keepsTrash ? [{ id: "demo.1", shot: "demo", name: "Demo", removedAt: "2026-12-24T08:00:00Z" }] : [];
      return Promise.resolve();
    },
    restore: (entry) => {
      if (trash[0]?.id !== entry) return Promise.reject(errorOf(404, { code: "not_in_trash", detail: "It is gone." }));
      [shots, trash] = [[SHOT], []];
      return Promise.resolve(SHOT);
    },
    release: () => Promise.resolve(void (shots = [SHOT])),
  };
  const failed: unknown[] = [];
  const library = new Library(service as Service, (error) => failed.push(error));
  return { library, failed, quarantine: () => (shots = [{ ...SHOT, quarantine: "it ends its workers" }]) };
}

describe("a deleted shot", () => {
  it("is offered again, and restored", async () => {
    const { library, failed } = shelf();
    await library.remove("demo");
    const removed = library.removed.value;
    expect([library.shots.value, removed?.id, library.trash.value.length]).toEqual([[], "demo.1", 1]);
    if (removed) await library.restore(removed);
    expect([library.shots.value, library.trash.value, library.removed.value]).toEqual([[SHOT], [], null]);
    await expect(removed && library.restore(removed)).rejects.toThrow("It is gone.");
    expect(failed).toEqual([]);
  });

  it("is not offered where nothing is kept", async () => {
    const { library } = shelf(false);
    await library.remove("demo");
    expect([library.removed.value, library.trash.value]).toEqual([null, []]);
  });
});

it("a shot in quarantine has its reason until it is released", async () => {
  const { library, quarantine } = shelf();
  quarantine();
  await library.refresh();
  expect(library.shots.value?.[0]?.quarantine).toBe("it ends its workers");
  await library.release("demo");
  expect(library.shots.value?.[0]?.quarantine).toBeNull();
});

describe("a zip with several stages", () => {
  /** A service that takes a zip only with a root, and what it was sent. */
  function choosy(): { library: Library; sent: Sending[]; failing: { with: Error | null } } {
    const [sent, failing]: [Sending[], { with: Error | null }] = [[], { with: null }];
    const errors = ["a.usda", "b.usda"].map((path) => ({ path, detail: "It could be the root." }));
    const service: Partial<Service> = {
      shots: () => Promise.resolve([SHOT]),
      upload: (sending) => {
        sent.push(sending);
        if (failing.with) return Promise.reject(failing.with);
        if (sending.root !== null) return Promise.resolve(SHOT);
        return Promise.reject(errorOf(422, { code: "ambiguous_root", detail: "It holds several.", errors }));
      },
    };
    const library = new Library(service as Service, () => undefined);
    return { library, sent, failing };
  }

  it("offers them, and is sent again with the chosen one", async () => {
    const { library, sent } = choosy();
    const file = new File(["zip"], "set.zip");
    expect(await library.upload(file)).toBeNull();
    const [upload] = library.uploads.value;
    expect([upload?.candidates, upload?.complaint]).toEqual([["a.usda", "b.usda"], null]);
    if (upload) expect(await library.chooseRoot(upload, "b.usda")).toBe(SHOT);
    expect(sent).toEqual([
      { file, root: null },
      { file, root: "b.usda" },
    ]);
    expect([library.uploads.value, library.shots.value]).toEqual([[], [SHOT]]);
  });

  it("says why the chosen one was refused, and is dismissed as any other", async () => {
    const { library, failing } = choosy();
    await library.upload(new File(["zip"], "set.zip"));
    const [upload] = library.uploads.value;
    failing.with = errorOf(422, { code: "bad_stage", detail: "It is damaged." });
    if (upload) expect(await library.chooseRoot(upload, "a.usda")).toBeNull();
    expect(library.uploads.value[0]).toMatchObject({ candidates: [], complaint: { message: "It is damaged." } });
    library.dismiss(upload?.id ?? -1);
    expect(library.uploads.value).toEqual([]);
  });
});
