/** Commands: what can be done on the page, for the keyboard, the menus and the command palette alike. */

import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";

export const MENUS = ["Shot", "Edit", "Focus", "Keys", "Play", "Picture", "View"] as const;
export type MenuName = (typeof MENUS)[number];

/** What a command acts on. */
export interface Place {
  readonly editor: Editor;
  readonly session: Session | null;
  /** Whether the keyboard is in the timeline. */
  readonly isInTimeline: boolean;
}

export interface Command {
  readonly name: string;
  readonly menu: MenuName;
  /** Chords of the keyboard; the first one is shown. One without any is in the menus, and in the list of all commands. */
  readonly keys: readonly string[];
  /** Whether it is done again and again while its key is held down. */
  readonly repeats?: boolean;
  /** Whether its keys mean it now, where another command has them, too. */
  readonly wantsKey?: (place: Place) => boolean;
  /** State of a switch or of a choice among others. */
  readonly isOn?: (place: Place) => boolean;
  /** Why it can do nothing now; null where it can. */
  readonly refusal: (place: Place) => string | null;
  readonly act: (place: Place) => void;
  /** Ends what it began, where its key was held down for a while. */
  readonly letGo?: (place: Place) => void;
}

/** A command without what is the same for all of a menu. */
type Unplaced = Omit<Command, "menu" | "refusal"> & Partial<Pick<Command, "refusal">>;

/** A command that needs no open shot. */
export function always(menu: MenuName, command: Unplaced): Command {
  return { menu, refusal: () => null, ...command };
}

export interface SessionCommand {
  readonly name: string;
  readonly keys: readonly string[];
  readonly repeats?: boolean;
  readonly wantsKey?: (session: Session, place: Place) => boolean;
  readonly isOn?: (session: Session, place: Place) => boolean;
  readonly refusal?: (session: Session, place: Place) => string | null;
  readonly act: (session: Session, place: Place) => void;
  readonly letGo?: (session: Session, place: Place) => void;
}

/** A command on the open shot. */
export function onShot(menu: MenuName, { wantsKey, isOn, refusal, act, letGo, ...rest }: SessionCommand): Command {
  return {
    ...rest,
    menu,
    ...(wantsKey && { wantsKey: (place) => place.session !== null && wantsKey(place.session, place) }),
    ...(isOn && { isOn: (place) => place.session !== null && isOn(place.session, place) }),
    ...(letGo && {
      letGo: (place: Place) => {
        if (place.session) letGo(place.session, place);
      },
    }),
    refusal: (place) => (place.session === null ? "No shot is open." : (refusal?.(place.session, place) ?? null)),
    act: (place) => {
      if (place.session) act(place.session, place);
    },
  };
}

/** The value after another one, around the end. */
export function nextOf<Value>(values: readonly Value[], value: Value): Value {
  return values[(values.indexOf(value) + 1) % values.length] ?? value;
}
