/** Tells the person of an error; `again` does once more what failed. */
export type Fail = (error: unknown, again: () => void) => void;
