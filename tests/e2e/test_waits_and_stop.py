"""The poster before the first picture, an opening that is stopped, and the one stop by keyboard, in a real browser."""

from __future__ import annotations

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.editor import wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

GLASS = 0.64
"""Share of the light that passes: T is 1.25 times f."""


def test_a_poster_stands_for_a_shot_that_is_opened(page: Page) -> None:
    wait_settled(page, time=1)
    opening = "**/v1/shots/demo"
    page.route(opening, lambda _: None)
    page.reload()
    poster = page.locator(".poster")
    expect(poster).to_contain_text("Demo shot: opening through a thin 50 mm lens at f/1.4…")
    assert poster.locator("img").evaluate("picture => picture.decode().then(() => picture.naturalWidth)") == 320

    page.get_by_role("button", name="Stop opening Demo shot").click()
    expect(page.get_by_role("heading", name="No shot is open")).to_be_visible()
    page.unroute(opening)
    page.get_by_role("button", name="Open the demo shot").click()
    expect(poster).to_be_visible()
    page.locator("canvas[data-stage]").wait_for()
    expect(poster).to_have_count(0)


@pytest.fixture
def lens(page: Page, service: str) -> Page:
    """The editor with a lens at f/1.4 whose glass takes light."""
    values = {"transmittance": GLASS}
    edit = {
        "camera": "/World/main_cam",
        "label": "Glass",
        "changes": [
            {"type": "setExposure", "values": values},
            {"type": "setCamera", "values": {"fStop": 1.4}},
        ],
    }
    httpx.post(f"{service}/v1/shots/demo/edits", json=edit, timeout=120).raise_for_status()
    page.reload()
    expect(page.get_by_role("textbox", name="f-number")).to_have_value("f/1.4")
    expect(page.get_by_role("textbox", name="T-stop")).to_have_value("T 1.75")
    return page


def test_one_stop_by_keyboard(lens: Page) -> None:
    number, t_stop = lens.get_by_role("textbox", name="f-number"), lens.get_by_role("textbox", name="T-stop")
    lens.get_by_role("slider", name="f-number").focus()
    for at in ("f/1.6", "f/1.8", "f/2"):
        lens.keyboard.press("ArrowRight")
        expect(number).to_have_value(at)
    expect(t_stop).to_have_value("T 2.5")
    lens.keyboard.press("Alt+ArrowRight")
    expect(number).to_have_value("f/2.02")

    t_stop.fill("3.5")
    t_stop.press("Enter")
    expect(number).to_have_value("f/2.8")
    number.fill("T 5")
    number.press("Enter")
    expect(number).to_have_value("f/4")
    expect(t_stop).to_have_value("T 5")
