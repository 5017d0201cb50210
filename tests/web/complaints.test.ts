import { complaintOf, errorOf } from "@/net/errors";

describe("a refused edit", () => {
  it.each([404, 409, 412, 429, 503])("is offered again after status %i, which may pass", (status) => {
    expect(complaintOf(errorOf(status, { code: "refused", detail: "no" })).remedy).toBe("retry");
  });

  it.each([403, 422])("is not offered again after status %i, which stays", (status) => {
    expect(complaintOf(errorOf(status, { code: "refused", detail: "no" })).remedy).toBeNull();
  });
});
