"""Two browsers at one shot: how soon an edit in one of them is seen in the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from render.errors import PullfocusError
from service.bench.page.browser import fresh_page, open_demo, wait_settled
from service.bench.page.controls import FRAME
from service.bench.page.plan import PagePlan

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

STOPS = ("2.8", "4", "5.6", "8")
WITHIN_MS = 60_000


@dataclass(frozen=True)
class Seen:
    """Delays of one edit, from the key press that makes it in one browser to a frame on the screen of the other.

    Attributes:
        value_s: the first frame with the new value in its panel, s.
        picture_s: the first frame with a picture of the new state, s.
    """

    value_s: float
    picture_s: float


def edits_seen(browser: Browser, port: int, plan: PagePlan) -> list[Seen]:
    """Set the f-number in one browser again and again, and look for it in another one, both by turns.

    Args:
        browser: both are contexts of it, which share nothing.
        port: of the service.
        plan: size of the windows, and number of edits.

    Raises:
        PullfocusError: an edit is not seen.
    """
    with fresh_page(browser, port, plan) as one, fresh_page(browser, port, plan) as other:
        pages = (one, other)
        for page in pages:
            open_demo(page, FRAME)
        found = []
        for number in range(plan.shared_edits):
            for page in pages:
                wait_settled(page)
            one.wait_for_timeout(500)  # what follows an edit at rest is over
            found.append(_edit_seen(pages[number % 2], pages[1 - number % 2], STOPS[number % len(STOPS)]))
        return found


def _edit_seen(writer: Page, reader: Page, stop: str) -> Seen:
    field = writer.get_by_role("textbox", name="f-number")
    field.fill(stop)
    writer.evaluate("() => pullfocusProbe.noteNext('keydown')")
    reader.evaluate(
        "([selector, within]) => pullfocusProbe.watchOther(selector, 'value', within)",
        ["input[aria-label='f-number']:not([type=range])", WITHIN_MS],
    )
    field.press("Enter")
    seen = reader.evaluate("() => pullfocusProbe.result()")
    since = writer.evaluate("() => pullfocusProbe.noted()")
    if seen is None:
        raise PullfocusError(f"an edit was not seen by the other browser within {WITHIN_MS / 1000:g} s")
    return Seen((seen["value"] - since) / 1000, (seen["picture"] - since) / 1000)
