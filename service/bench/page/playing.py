"""Cached playback: a range of the demo shot is cached by the page's own controls, and played."""

from __future__ import annotations

import re
from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING

from service.bench.page.browser import PATIENCE_S, open_demo, wait_settled

if TYPE_CHECKING:
    from playwright.sync_api import Page

FIRST = 25
"""First frame that is cached."""


@dataclass(frozen=True)
class Played:
    """A range that was cached and played.

    Attributes:
        cache_s: time that the caching took, s.
        said: what the page says of its cache.
        painted_s: times at which pictures were painted, s since the first; the last one is the end of the playing.
        dropped: frames dropped, as the page counts them.
    """

    cache_s: float
    said: str
    painted_s: list[float]
    dropped: int


def cache_and_play(page: Page, frames: int, seconds: float) -> Played:
    """Cache and play a range.

    Args:
        page: fresh.
        frames: length of the range.
        seconds: time that it plays, over and over, s.
    """
    last = FIRST + frames - 1
    open_demo(page, FIRST)
    page.keyboard.press("i")
    _go_to(page, last)
    page.keyboard.press("o")
    page.get_by_role("button", name="Playback").click()
    began_s = monotonic()
    # Disabled where all are cached, as few frames soon are: then there is nothing to wait for.
    page.get_by_role("button", name="Cache range").evaluate("button => button.click()")
    page.wait_for_function(
        "said => document.querySelector('[data-reading=cached]')?.textContent === said", arg=f"{frames} of {frames}"
    )
    cache_s = monotonic() - began_s
    said = re.sub(r"\s+", " ", page.locator(".playback [role=status]").inner_text())
    page.keyboard.press("Escape")
    page.evaluate("() => document.activeElement?.blur()")
    _go_to(page, FIRST)
    page.evaluate("() => { pullfocusProbe.drawn.length = 0; }")
    page.keyboard.press("l")
    page.wait_for_timeout(1000 * seconds)
    # The end counts, too, so that playing that stops early is seen.
    painted: list[float] = page.evaluate("() => [...pullfocusProbe.drawn.map(({ at }) => at), performance.now()]")
    dropped = page.locator("[data-reading=dropped]").inner_text()
    page.keyboard.press("k")
    return Played(cache_s, said, [(at - painted[0]) / 1000 for at in painted], int(dropped))


def _go_to(page: Page, frame: int) -> None:
    field = page.get_by_role("textbox", name="Frame", exact=True)
    field.fill(str(frame))
    field.press("Enter")
    page.wait_for_selector(f'canvas[data-time="{frame}"]', timeout=1000 * PATIENCE_S)
    wait_settled(page)
