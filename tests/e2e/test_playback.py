"""Playing frames that are cached, by mouse and by keyboard alone, in a real browser."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest
from playwright.sync_api import Page, WebSocket, expect

from tests.e2e.editor import revision_of, wait_edited, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

FIRST, LAST = 40, 42
WATCH = """() => {
    const canvas = document.querySelector("canvas");
    window.times = [];
    new MutationObserver(() => window.times.push(Number(canvas.dataset.time)))
        .observe(canvas, { attributes: true, attributeFilter: ["data-time"] });
}"""


@pytest.fixture
def requested(page: Page) -> list[dict[str, Any]]:
    """Requests for live pictures; the page is at the first frame that is played, at rest."""
    sent: list[dict[str, Any]] = []

    def listen(socket: WebSocket) -> None:
        socket.on("framesent", lambda message: sent.append(json.loads(message)))

    page.on("websocket", listen)
    page.goto(f"/?shot=demo&time={FIRST}")
    wait_settled(page, time=FIRST)
    return sent


def wait_cached(page: Page, count: int) -> None:
    """Wait until the cache bar has so many frames."""
    expect(page.locator(".cached")).to_have_attribute("data-cached", str(count))


def play_a_while(page: Page, start: str) -> list[int]:
    """Play with a key or by the transport until ten pictures were shown, pause, and return their times."""
    page.evaluate(WATCH)
    if start == "Play":
        page.get_by_role("button", name="Play", exact=True).click()
    else:
        page.keyboard.press(start)
    page.wait_for_function("() => window.times.length >= 10")
    expect(page.locator("[data-reading=rate]")).to_have_text(re.compile(r"^\d+\.\d$"))
    expect(page.locator("[data-reading=dropped]")).to_have_text(re.compile(r"^\d+$"))
    page.keyboard.press("k")
    expect(page.locator(".rate")).to_have_count(0)
    times: list[int] = page.evaluate("() => window.times")
    return times


def requests_within(sent: list[dict[str, Any]]) -> int:
    """Number of requests for pictures of things that move."""
    return sum(bool(message.get("moving")) for message in sent)


def test_a_range_is_cached_and_played_by_mouse(page: Page, requested: list[dict[str, Any]]) -> None:
    page.get_by_role("button", name="Playback").click()
    page.get_by_role("button", name="In here").click()
    page.get_by_label("Last frame that is played").fill(str(LAST))
    page.get_by_label("Last frame that is played").press("Enter")
    page.get_by_role("button", name="Cache range").click()
    expect(page.locator("[data-reading=cached]")).to_have_text("3 of 3")
    wait_cached(page, 3)

    page.get_by_label("Repeat", exact=True).select_option("pingPong")
    requested.clear()
    times = play_a_while(page, "Play")

    assert set(times) == {FIRST, FIRST + 1, LAST}
    assert requests_within(requested) == 0, "cached frames are asked of nobody"
    page.get_by_role("button", name="Playback").click()
    page.get_by_role("button", name="Clear").click()
    wait_cached(page, 0)


def test_a_range_is_cached_and_played_by_keys(page: Page, requested: list[dict[str, Any]]) -> None:
    """It stays cached after an edit that changes none of its pictures, and is made again after one that does."""
    page.keyboard.press("i")
    for _ in range(LAST - FIRST):
        page.keyboard.press("ArrowRight")
    page.keyboard.press("o")
    page.get_by_role("button", name="Playback").focus()
    page.keyboard.press("Enter")
    page.get_by_role("button", name="Cache range").focus()
    page.keyboard.press("Enter")
    wait_cached(page, 3)
    page.keyboard.press("Escape")
    page.keyboard.press("Escape")
    wait_settled(page, time=LAST)

    requested.clear()
    assert set(play_a_while(page, "l")) == {FIRST, FIRST + 1, LAST}
    assert set(play_a_while(page, "j")) == {FIRST, FIRST + 1, LAST}
    assert requests_within(requested) == 0

    page.keyboard.press("End")
    wait_settled(page, time=96)
    for name in ("pip", "mara"):  # the last keys repeat the values of those before
        page.get_by_role("button", name=name, exact=True).first.click()
        revision = revision_of(page)
        page.keyboard.press("s")
        wait_edited(page, revision)
    wait_cached(page, 3)

    page.get_by_role("slider", name="f-number").focus()
    page.keyboard.press("ArrowRight")
    wait_cached(page, 0)
    wait_cached(page, 3)
