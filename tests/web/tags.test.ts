import { noteAddress, pointAddress, TagBooks } from "@/net/tags";

describe("entity tags of notes", () => {
  it("outlive an undo of other things", async () => {
    const books = new TagBooks();
    const book = books.of({ shot: "demo", camera: null });
    const tell = book.reading();
    tell(noteAddress("n"), '"n"');
    tell(pointAddress("a"), '"a"');
    await books.asWhole("demo", () => Promise.resolve());
    expect(book.ifMatch([{ type: "editNote", id: "n", values: { text: "later" } }])).toBe('"n"');
    expect(book.ifMatch([{ type: "alterPoint", name: "a", values: { weight: 0.5 }, time: 1 }])).toBeNull();
  });
});
