"""Fresh opens of the demo shot: from the navigation to the first picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from service.bench.page.browser import fresh_page
from service.bench.page.plan import PagePlan

if TYPE_CHECKING:
    from playwright.sync_api import Browser


@dataclass(frozen=True)
class Opened:
    """A fresh open, in seconds since its navigation began.

    Attributes:
        loaded_s: end of the load event: the page is up.
        contentful_s: first paint with content.
        picture_s: first picture on screen.
    """

    loaded_s: float
    contentful_s: float
    picture_s: float


def open_fresh(browser: Browser, port: int, plan: PagePlan) -> Opened:
    """Open the demo shot in a browser context that knows nothing of the service.

    Args:
        browser: it opens in.
        port: of the service.
        plan: size of the window.
    """
    with fresh_page(browser, port, plan) as page:
        page.goto("/?shot=demo&time=1")
        page.wait_for_function("() => pullfocusProbe.isOpened()")
        found = page.evaluate("() => pullfocusProbe.opening()")
        return Opened(*(found[name] / 1000 for name in ("loaded", "painted", "picture")))
