/** A drag: its values are previewed in the picture, and the last one is an edit. */
export interface Drag<Value> {
  move(value: Value): void;
  commit(value: Value): void;
  /** Leaves the shot as it was. */
  cancel(): void;
}
