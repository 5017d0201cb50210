import { signal } from "@preact/signals";
import { ShotDocument } from "@/editor/document";
import { Others } from "@/editor/others";
import type { Change } from "@/model/changes";
import { FakeService, SHOT, turn } from "./fake_service";

function setStop(fStop: number): Change {
  return { type: "setCamera", values: { fStop } };
}

async function opened(): Promise<{ fake: FakeService; document: ShotDocument; others: Others }> {
  const fake = new FakeService();
  const document = new ShotDocument(fake.service, SHOT, "/cam", signal(1), () => undefined);
  await document.catchUp();
  return { fake, document, others: new Others(fake.service, document) };
}

async function tell(fake: FakeService, revision?: string | null): Promise<void> {
  fake.editsListener?.onEdits(revision === undefined ? (await fake.history()).revision : revision);
  await turn();
}

describe("edits of others", () => {
  it("are shown when they are told, each once", async () => {
    const { fake, document } = await opened();
    fake.othersDo(setStop(11));
    await tell(fake);
    expect(document.undoLabel.value).toBe("What the other did");
    expect(document.revision.value).toBe(1);
    await tell(fake);
    await tell(fake, null);
    expect(document.revision.value).toBe(1);
  });

  it("are found where some may have been missed", async () => {
    const { fake, document } = await opened();
    fake.othersDo(setStop(11));
    await tell(fake, null);
    expect(document.undoLabel.value).toBe("What the other did");
  });

  it("are not read again for what was done here", async () => {
    const { fake, document } = await opened();
    await document.edit("a", [setStop(4)]);
    const read = vi.spyOn(fake, "history");
    await tell(fake, document.history.value.revision);
    expect(read).not.toHaveBeenCalled();
  });

  it("are told no more once the shot is closed", async () => {
    const { fake, others } = await opened();
    others.close();
    expect(fake.editsListener).toBeNull();
  });
});

describe("edits of others whose revision is told", () => {
  it("are read at once where their revision is told, beside the history", async () => {
    const { fake, document } = await opened();
    fake.othersDo(setStop(11));
    const [history, asked] = [await fake.history(), vi.spyOn(fake, "history")];
    let answer: () => void = () => undefined;
    asked.mockImplementationOnce(
      () =>
        new Promise(
          (resolve) =>
            (answer = () => {
              resolve(history);
            }),
        ),
    );
    await tell(fake, history.revision);
    expect([document.revision.value, document.undoLabel.value]).toEqual([1, null]);
    answer();
    await turn();
    expect([document.revision.value, document.undoLabel.value]).toEqual([1, "What the other did"]);
  });

  it("are read again where the history is beyond what was told", async () => {
    const { fake, document } = await opened();
    fake.othersDo(setStop(11));
    const { revision } = await fake.history();
    fake.othersDo(setStop(8));
    await tell(fake, revision);
    expect(document.revision.value).toBe(2);
  });
});

describe("edits of others beside one's own", () => {
  it("wait for the end of a drag", async () => {
    const { fake, document } = await opened();
    document.preview([setStop(5)]);
    fake.othersDo(setStop(11));
    await tell(fake);
    expect(document.revision.value).toBe(0);
    document.endPreview();
    await turn();
    expect(document.undoLabel.value).toBe("What the other did");
  });

  it("wait for a drag that begins while they are read", async () => {
    const { fake, document } = await opened();
    fake.othersDo(setStop(11));
    const told = tell(fake, null);
    document.preview([setStop(5)]);
    await told;
    expect(document.revision.value).toBe(0);
    document.endPreview();
    await turn();
    expect(document.undoLabel.value).toBe("What the other did");
  });

  it("are read after an edit here whose answer is older", async () => {
    const { fake, document } = await opened();
    fake.onMade = () => {
      fake.onMade = () => undefined;
      queueMicrotask(() => {
        fake.othersDo(setStop(11));
        void tell(fake);
      });
    };
    await document.edit("a", [setStop(4)]);
    await turn();
    expect(fake.done).toEqual([setStop(4), setStop(11)]);
    expect(document.undoLabel.value).toBe("What the other did");
  });
});
