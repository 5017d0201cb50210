import { faultOfFrames } from "@/model/frame_range";

// As tests/service/jobs/test_frame_ranges.py has it.
describe("a range of frames", () => {
  it.each(["7", "1-10", "1-10:2", "1-10:2,15", "-5--1", " 1 - 3 : 2 ", "10-1:-3", "-3", "1-10000"])(
    "%j is one",
    (text) => {
      expect(faultOfFrames(text)).toBeNull();
    },
  );

  it.each([
    ["", "Type frames such as 1-10:2,15."],
    ["[1-96", "Type frames such as 1-10:2,15."],
    ["1,,2", "Type frames such as 1-10:2,15."],
    ["1.5", "Type frames such as 1-10:2,15."],
    ["5-1", "The step of '5-1' does not lead from its first frame to its last."],
    ["1-5:0", "The step of '1-5:0' does not lead from its first frame to its last."],
    ["1-5,3", "Frame 3 comes twice."],
    ["1-10001", "A render has 10,000 frames at most."],
    ["1-9000,20001-29000", "A render has 10,000 frames at most."],
    ["2000000000", "Frames lie between -1,000,000,000 and 1,000,000,000."],
  ])("%j is none", (text, fault) => {
    expect(faultOfFrames(text)).toBe(fault);
  });
});
