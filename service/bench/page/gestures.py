"""Random gestures on the page: pressed keys, clicks, drags, typed and chosen values, turns of the wheel."""

from __future__ import annotations

import random
from collections import Counter, deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from playwright.sync_api import Page

KEYS = (
    *("ArrowLeft", "ArrowRight", "Shift+ArrowLeft", "Shift+ArrowRight", "ArrowUp", "ArrowDown", "Home", "End"),
    *("[", "]", "f", ",", ".", "s", "m", "p", "Shift+P", "c", "g", "+", "-", "Delete", "Escape", "?", "Tab", "Enter"),
    *("Space", "j", "k", "l", "i", "o", "Shift+I", "Shift+O"),
    *("Control+z", "Control+z", "Control+z", "Control+Shift+z", "Control+c", "Control+v", "Control+a"),
)
TEXTS = ("2.8", "50", "1.5 m", "∞", "24", "0.3", "0", "-3", "1e9", "abc", "", "f/4", "1/50", "3200")
PAUSES_MS = (20, 20, 50, 100, 100, 200, 400, 1000, 4000)
KEPT_GESTURES = 12
"""Gestures that are remembered, to be told with an error."""

# Buttons that leave the page, ask for a file, download, or remove the shot are left out.
PRESSABLE = (
    ".inspector button, .inspector summary, .inspector input[type=checkbox], .transport button, .topbar button, "
    ".lane-name, [role=menuitem], .menu-list button, .menu-list input, .picture-foot button, dialog[open] button"
)
LEFT_OUT = "download|import|file|add a shot|create a camera|\\.usda|\\.json|\\.csv|\\.otio|\\.png|\\.exr|sign"
FIELDS = "input.number, .inspector input.value"
CHOICES = ".inspector select, .transport select, .picture-foot select, .menu-list select"

FIND = """([selector, leftOut]) => {
    const isOut = new RegExp(leftOut, "i");
    const nameOf = (element) => element.getAttribute("aria-label") || element.title || element.textContent || element.className;
    return [...document.querySelectorAll(selector)].flatMap((element) => {
        const box = element.getBoundingClientRect();
        const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
        const name = String(nameOf(element)).trim().slice(0, 40);
        const isThere = box.width > 0 && !element.disabled && element.contains(document.elementFromPoint(x, y));
        return isThere && !isOut.test(name) ? [{ x, y, width: box.width, height: box.height, name }] : [];
    });
}"""
CHOOSE = """([selector, nth, share]) => {
    const found = [...document.querySelectorAll(selector)].filter((choice) => !choice.disabled && choice.checkVisibility());
    const choice = found[Math.floor(nth * found.length)];
    const options = choice ? [...choice.options].filter((option) => !option.disabled) : [];
    if (options.length === 0) return null;
    choice.value = options[Math.floor(share * options.length)].value;
    choice.dispatchEvent(new Event("change", { bubbles: true }));
    return `${choice.getAttribute("aria-label") ?? choice.parentElement.textContent.slice(0, 20)}: ${choice.value}`;
}"""


@dataclass(frozen=True)
class _Found:
    """An element on screen: its centre and size, CSS pixels, and its name."""

    x: float
    y: float
    width: float
    height: float
    name: str


class Gestures:
    """Random gestures on a page.

    Args:
        page: with a shot.
        seed: of what is done.
    """

    def __init__(self, page: Page, seed: int) -> None:
        self._page, self._random = page, random.Random(seed)
        self.kinds: Counter[str] = Counter()
        self.last: deque[str] = deque(maxlen=KEPT_GESTURES)
        self._all: tuple[tuple[Callable[[], str | None], int], ...] = (
            (self._press_key, 10),
            (self._press_control, 8),
            (self._click_picture, 3),
            (self._drag_marker, 2),
            (self._drag_slider, 4),
            (self._type, 3),
            (self._choose, 2),
            (self._scrub, 3),
            (self._drag_key, 5),
            (self._drag_handle, 2),
            (self._select_keys, 2),
            (self._open_key_menu, 2),
            (self._add_key, 1),
            (self._turn_wheel, 3),
            (self._show_curve, 1),
            (self._scroll_panel, 2),
        )

    def step(self) -> None:
        """Make one gesture and pause."""
        acts, weights = zip(*self._all, strict=True)
        act = self._random.choices(acts, weights)[0]
        told = act()
        if told is None:  # there is nothing to do it with now
            return
        kind = act.__name__.strip("_").replace("_", " ")
        self.kinds[kind] += 1
        self.last.append(f"{kind}: {told}")
        self._page.wait_for_timeout(self._random.choice(PAUSES_MS))

    def _find(self, selector: str) -> _Found | None:
        found: list[dict[str, Any]] = self._page.evaluate(FIND, [selector, LEFT_OUT])
        return _Found(**self._random.choice(found)) if found else None

    def _drag(self, start: tuple[float, float], way: tuple[float, float], modifiers: Sequence[str | None]) -> None:
        """Drag from a place by a way, perhaps with a modifier held, and perhaps give it up."""
        modifier = self._random.choice(modifiers)
        mouse, keyboard = self._page.mouse, self._page.keyboard
        steps = self._random.randint(2, 8)
        if modifier:
            keyboard.down(modifier)
        mouse.move(*start)
        mouse.down()
        for step in range(1, steps + 1):
            mouse.move(start[0] + way[0] * step / steps, start[1] + way[1] * step / steps)
            self._page.wait_for_timeout(self._random.choice((0, 10, 30, 100)))
        if self._random.random() < 0.1:
            keyboard.press("Escape")
        mouse.up()
        if modifier:
            keyboard.up(modifier)

    def _way(self, across: float, down: float) -> tuple[float, float]:
        return self._random.uniform(-across, across), self._random.uniform(-down, down)

    def _press_key(self) -> str:
        key = self._random.choice(KEYS)
        self._page.keyboard.press(key)
        return key

    def _press_control(self) -> str | None:
        control = self._find(PRESSABLE)
        if control is None:
            return None
        self._page.mouse.click(control.x, control.y)
        return control.name

    def _click_picture(self) -> str | None:
        picture = self._find(".picture")
        if picture is None:
            return None
        modifier = self._random.choice((None, None, "Shift", "Alt"))
        x = picture.x + self._random.uniform(-0.49, 0.49) * picture.width
        y = picture.y + self._random.uniform(-0.49, 0.49) * picture.height
        if modifier:
            self._page.keyboard.down(modifier)
        self._page.mouse.click(x, y)
        if modifier:
            self._page.keyboard.up(modifier)
        return f"{modifier or ''} {x:.0f} {y:.0f}"

    def _drag_marker(self) -> str | None:
        return self._drag_one(".marker", (200, 120), (None,))

    def _drag_slider(self) -> str | None:
        return self._drag_one("input.slider", (60, 0), (None,))

    def _drag_key(self) -> str | None:
        return self._drag_one("[data-stack], [data-knot]", (200, 30), (None, None, "Alt", "Shift"))

    def _drag_handle(self) -> str | None:
        return self._drag_one("[data-handle]", (100, 40), (None, "Alt"))

    def _drag_one(self, selector: str, reach: tuple[float, float], modifiers: Sequence[str | None]) -> str | None:
        found = self._find(selector)
        if found is None:
            return None
        way = self._way(*reach)
        self._drag((found.x, found.y), way, modifiers)
        return f"{found.name} by {way[0]:.0f} {way[1]:.0f}"

    def _scrub(self) -> str | None:
        return self._drag_one(".scrubber", (600, 0), (None,))

    def _select_keys(self) -> str | None:
        lanes = self._find(".lanes")
        if lanes is None:
            return None
        start = lanes.x + self._way(0.4 * lanes.width, 0)[0], lanes.y - lanes.height / 2 + 2
        self._drag(start, (self._way(400, 0)[0], self._random.uniform(5, lanes.height)), (None, "Shift"))
        return "box"

    def _open_key_menu(self) -> str | None:
        found = self._find("[data-stack], [data-knot]")
        if found is None:
            return None
        self._page.mouse.click(found.x, found.y, button="right")
        item = self._find("[role=menuitem]")
        if item is None:
            return found.name
        self._page.mouse.click(item.x, item.y)
        return f"{found.name}, {item.name}"

    def _add_key(self) -> str | None:
        graph = self._find(".graph")
        if graph is None:
            return None
        self._page.mouse.dblclick(graph.x + self._way(0.45 * graph.width, 0)[0], graph.y)
        return graph.name

    def _type(self) -> str | None:
        field = self._find(FIELDS)
        if field is None:
            return None
        text, end = self._random.choice(TEXTS), self._random.choice(("Enter", "Enter", "Tab", "Escape"))
        self._page.mouse.click(field.x, field.y)
        self._page.keyboard.press("Control+a")
        self._page.keyboard.insert_text(text)
        self._page.keyboard.press(end)
        return f"{field.name}: {text!r}, {end}"

    def _choose(self) -> str | None:
        chosen: str | None = self._page.evaluate(CHOOSE, [CHOICES, self._random.random(), self._random.random()])
        return chosen

    def _show_curve(self) -> str | None:
        chosen: str | None = self._page.evaluate(CHOOSE, [".curve-choice", 0, self._random.random()])
        return chosen

    def _turn_wheel(self) -> str | None:
        tracks = self._find(".tracks")
        if tracks is None:
            return None
        self._page.mouse.move(tracks.x + self._way(0.4 * tracks.width, 0)[0], tracks.y)
        modifier = self._random.choice((None, "Shift", "Control"))
        if modifier:
            self._page.keyboard.down(modifier)
        self._page.mouse.wheel(0, self._random.choice((-300, -100, 100, 300)))
        if modifier:
            self._page.keyboard.up(modifier)
        return f"{modifier or ''}"

    def _scroll_panel(self) -> str | None:
        panel = self._find(".inspector")
        if panel is None:
            return None
        self._page.mouse.move(panel.x, panel.y)
        self._page.mouse.wheel(0, self._random.choice((-600, -200, 200, 600)))
        return ""
