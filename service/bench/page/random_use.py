"""Random use of the page: rounds of gestures, after each of which everything is undone, compared and measured."""

from __future__ import annotations

from collections import Counter
from time import monotonic
from typing import TYPE_CHECKING

from service.bench.page.browser import PATIENCE_S, open_demo, wait_settled
from service.bench.page.controls import LOOKS
from service.bench.page.gestures import Gestures
from service.bench.page.memory import MemoryMeter
from service.bench.page.results import PageError, RandomUse, Round, growth_of
from service.bench.page.shot import read_edits

if TYPE_CHECKING:
    from playwright.sync_api import Page

ROUND_MINUTES = 1.0
_UNDO = 'button[aria-label^="Undo: "]:enabled'
_COMPLAINT = """() => {
    const complaint = document.querySelector(".complaint[role=alert]");
    const text = complaint?.querySelector("p")?.innerText ?? null;
    complaint?.querySelector("[aria-label=Dismiss]")?.click();
    return text;
}"""
_LOOK = "() => document.querySelector('canvas.sharpness')?.dataset.look ?? null"
_FOCUS_CURVE = """() => {
    const choice = document.querySelector(".curve-choice");
    if (!choice || choice.value === "") return;
    choice.value = "";
    choice.dispatchEvent(new Event("change", { bubbles: true }));
}"""
_WHOLE_SHOT = 'button:text-is("Whole shot")'
_FOLDED_PANELS = '.panels button[aria-pressed="false"]'
_HIDDEN_MARKERS = '[aria-label="Show focus points on the picture"][aria-pressed="false"]'
_STOPPED = 'button:text-is("Draw it")'
_UNDO_PAUSE_MS = 50


def use_at_random(page: Page, port: int, minutes: float, seed: int) -> RandomUse:
    """Use a page at random.

    Args:
        page: fresh, not probed.
        port: of the service.
        minutes: time of the gestures; undoing comes on top.
        seed: of the gestures.

    Raises:
        PullfocusError: the service refuses to tell the edits.
        OSError: it cannot be reached.
    """
    from playwright.sync_api import Error

    watch = _Watch(page)
    gestures = watch.gestures = Gestures(page, seed)
    open_demo(page, 1)
    meter = MemoryMeter(page)
    first = read_edits(port)
    before = meter.read()
    rounds: list[Round] = []
    count = max(1, round(minutes / ROUND_MINUTES))
    try:
        for _ in range(count):
            done = gestures.kinds.total()
            until_s = monotonic() + 60 * minutes / count
            while monotonic() < until_s:
                gestures.step()
                watch.note_complaint()
            _calm(page)
            undone = _undo_all(page, watch)
            _show_as_at_first(page)
            edits = read_edits(port)
            rounds.append(Round(gestures.kinds.total() - done, undone, edits == first, meter.read()))
    except Error as error:  # as where it never comes to rest; what was found until then is told
        watch.note(f"the page does not do what is expected: {error}")
    complaints = dict(watch.complaints.most_common())
    kinds = dict(gestures.kinds.most_common())
    return RandomUse(seed, minutes, kinds, before, rounds, watch.errors, complaints, growth_of(rounds))


class _Watch:
    """Errors in the page's console, and what the page complains of, with the gestures before."""

    def __init__(self, page: Page) -> None:
        self._page = page
        self.errors: list[PageError] = []
        self.complaints: Counter[str] = Counter()
        self.gestures: Gestures | None = None
        page.on("pageerror", lambda error: self.note(f"{error.name}: {error.message}\n{error.stack or ''}"))
        page.on("console", lambda said: self.note(f"{said.text} ({said.location})") if said.type == "error" else None)
        page.on("crash", lambda _: self.note("the page has crashed"))

    def note_complaint(self) -> None:
        """Count what the page complains of now, and dismiss it."""
        text: str | None = self._page.evaluate(_COMPLAINT)
        if text is not None:
            self.complaints[text] += 1

    def note(self, text: str) -> None:
        """Note an error, with the gestures before it."""
        self.errors.append(PageError(text, list(self.gestures.last) if self.gestures else []))


def _calm(page: Page) -> None:
    """Stop what goes on: close what is open, let go of the keyboard, pause."""
    for _ in range(3):
        page.keyboard.press("Escape")
    page.evaluate("() => document.activeElement?.blur()")
    page.keyboard.press("k")
    if (stopped := page.locator(_STOPPED)).count() > 0:
        stopped.first.click()
    wait_settled(page)


def _undo_all(page: Page, watch: _Watch) -> int:
    """Undo by the keyboard until nothing is left, and return how many presses that took."""
    presses, until_s = 0, monotonic() + PATIENCE_S
    while monotonic() < until_s:
        if page.locator(_UNDO).count() == 0:
            wait_settled(page)  # an edit may have been under way
            if page.locator(_UNDO).count() == 0:
                break
        page.keyboard.press("Control+z")
        presses += 1
        page.wait_for_timeout(_UNDO_PAUSE_MS)
        watch.note_complaint()
    return presses


def _show_as_at_first(page: Page) -> None:
    """Show of the page what it showed when it was opened, so that its memory compares."""
    while (folded := page.locator(_FOLDED_PANELS)).count() > 0:
        folded.first.click()
    for tab in ("Camera & film", "Lens & focus"):  # what was unfolded in a panel is folded again
        page.get_by_role("tab", name=tab).click()
    page.evaluate("() => document.activeElement?.blur()")
    for key in ("Shift+I", "Shift+O", "Home"):
        page.keyboard.press(key)
    for _ in range(LOOKS):
        if page.evaluate(_LOOK) in (None, "none"):
            break
        page.keyboard.press("p")
    if page.evaluate(_LOOK) is not None:
        page.keyboard.press("Shift+P")
    page.evaluate(_FOCUS_CURVE)
    for selector in (_WHOLE_SHOT, _HIDDEN_MARKERS):
        if page.locator(selector).count() > 0:
            page.locator(selector).click()
    page.keyboard.press("Escape")
    page.evaluate("() => document.activeElement?.blur()")
    wait_settled(page)
