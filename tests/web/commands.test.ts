import { signal } from "@preact/signals";
import { Layout } from "@/editor/layout";
import { Remembered } from "@/editor/remembered";
import { Waits } from "@/editor/waits";
import { isChord, shownChord, type KeyStroke } from "@/view/commands/chord";
import { MENUS, type Place } from "@/view/commands/command";
import { GESTURES } from "@/view/commands/gestures";
import { commandOf, COMMANDS, commandsOf, found, shownKeys } from "@/view/commands/table";

const PLAIN = { ctrlKey: false, metaKey: false, shiftKey: false, altKey: false };

function stroke(key: string, held: Partial<KeyStroke> = {}): KeyStroke {
  return { key, code: /^[a-z]$/i.test(key) ? `Key${key.toUpperCase()}` : key, ...PLAIN, ...held };
}

describe("a chord", () => {
  it.each<[string, KeyStroke, boolean]>([
    ["Ctrl Z", stroke("z", { ctrlKey: true }), true],
    ["Ctrl Z", stroke("z", { metaKey: true }), true],
    ["Ctrl Z", stroke("Z", { ctrlKey: true, shiftKey: true }), false],
    ["P", stroke("p"), true],
    ["P", stroke("P"), true], // Caps Lock
    ["P", stroke("P", { shiftKey: true }), false],
    ["Shift P", stroke("P", { shiftKey: true }), true],
    ["?", stroke("?", { shiftKey: true }), true],
    ["+", stroke("+"), true],
    ["Space", stroke(" "), true],
    ["Shift 1", stroke("!", { code: "Digit1", shiftKey: true }), true],
    ["1", stroke("&", { code: "Digit1" }), true], // a French keyboard
    ["Alt J", stroke("∆", { code: "KeyJ", altKey: true }), true], // a Mac
    ["J", stroke("j", { altKey: true }), false],
    ["ArrowLeft", stroke("ArrowLeft", { shiftKey: true }), false],
  ])("%s and %o: %s", (chord, pressed, expected) => {
    expect(isChord(chord, pressed)).toBe(expected);
  });

  it("is shown by signs", () => {
    expect(shownChord("Shift ArrowLeft")).toBe("Shift ←");
  });
});

const REMEMBERED = new Remembered();

/** A place with no open shot. */
const NOWHERE: Place = {
  editor: {
    remembered: REMEMBERED,
    layout: new Layout(REMEMBERED),
    identity: { noEdits: signal(null), who: signal(null) },
    library: { shots: signal([]) },
    waits: new Waits(),
  } as unknown as Place["editor"],
  session: null,
  isInTimeline: false,
};

describe("the commands", () => {
  it("have each a menu, and all but those of other people a key", () => {
    for (const { menu } of COMMANDS) expect(MENUS).toContain(menu);
    const without = COMMANDS.filter(({ keys }) => keys.length === 0).map(({ name }) => name);
    expect(without).toEqual(["Who else is here", "Go to the frame of the next person here"]);
    expect(MENUS.flatMap(commandsOf)).toHaveLength(COMMANDS.length);
  });

  it("have names of their own", () => {
    expect(new Set(COMMANDS.map(({ name }) => name)).size).toBe(COMMANDS.length);
  });

  it("share keys only where they mean different things at different times", () => {
    const keys = COMMANDS.flatMap((command) => command.keys);
    const shared = new Set(keys.filter((key, at) => keys.indexOf(key) !== at));
    expect([...shared].toSorted()).toEqual(["Backspace", "Ctrl Z", "Delete", "Escape", "F"]);
  });

  it("say why they can do nothing without a shot", () => {
    expect(commandOf(stroke(" "), NOWHERE)).toBeNull();
    expect(COMMANDS.find(({ name }) => name === "Play or pause")?.refusal(NOWHERE)).toBe("No shot is open.");
  });

  it("do what needs no shot", () => {
    REMEMBERED.settingsPanel.value = "off";
    commandOf(stroke("c"), NOWHERE)?.act(NOWHERE);
    expect(NOWHERE.editor.remembered.panel.value).toBe("camera");
    expect(REMEMBERED.settingsPanel.value).toBe("on");
    const markers = commandOf(stroke("m"), NOWHERE);
    expect(markers?.isOn?.(NOWHERE)).toBe(true);
    markers?.act(NOWHERE);
    expect(markers?.isOn?.(NOWHERE)).toBe(false);
  });

  it("are found by their words, in any order", () => {
    expect(found("frame last").map(({ name }) => name)).toContain("Last frame");
    expect(found("no such command")).toEqual([]);
    expect(found("  ")).toHaveLength(COMMANDS.length);
  });
});

describe("the keys in the guide", () => {
  it("are those of the commands (vitest -u writes them)", async () => {
    const row = (keys: string, does: string): string => `| \`${keys}\` | ${does} |`;
    const table = (title: string, head: string, rows: readonly string[]): string =>
      [`### ${title}`, "", `| ${head} | effect |`, "|---|---|", ...rows].join("\n");
    const tables = [
      table(
        "Clicks and drags",
        "gesture",
        GESTURES.map(({ gesture, does }) => row(gesture, does)),
      ),
      ...MENUS.map((menu) =>
        table(
          menu,
          "key",
          commandsOf(menu)
            .filter(({ keys }) => keys.length > 0)
            .map((command) => row(shownKeys(command), command.name)),
        ),
      ),
    ];
    await expect(`${tables.join("\n\n")}\n`).toMatchFileSnapshot("../../docs/_site/keys.md");
  });
});
