/** A choice that shows at once, and for as long as its edit is under way. */

import { signal } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";

interface Choice<Value> {
  readonly value: Value;
  /** Time of the shot that it is for; it does not show at another one. */
  readonly at: number;
  /** Whether its edit has been made, or refused. */
  readonly isDone: boolean;
}

export class Chosen<Value> {
  readonly choice = signal<Choice<Value> | null>(null);

  /** @param edit ends where the service has the value, or has refused it. */
  choose(value: Value, edit: Promise<unknown>, at = 0): void {
    const choice = { value, at, isDone: false };
    this.choice.value = choice;
    const done = (): void => {
      if (this.choice.peek() === choice) this.choice.value = { ...choice, isDone: true };
    };
    void edit.then(done, done);
  }

  /** Gives way to the saved value, once that is what came of the edit. */
  settle(fresh: boolean): void {
    if (fresh && this.choice.peek()?.isDone) this.choice.value = null;
  }
}

/**
 * The value that shows, and what takes choices.
 *
 * @param saved value as it was read last.
 * @param fresh whether it is what the service has now.
 * @param at time of the shot, where the value is one of that time.
 */
export function useChosen<Value>(saved: Value, fresh: boolean, at = 0): readonly [Value, Chosen<Value>] {
  const [chosen] = useState(() => new Chosen<Value>());
  const choice = chosen.choice.value;
  useEffect(() => {
    chosen.settle(fresh);
  }, [chosen, choice, fresh]);
  return [choice?.at === at ? choice.value : saved, chosen];
}
