"""Waits that are stopped, the poster before the first picture, and the one stop by mouse and by keyboard, in a real browser."""

from __future__ import annotations

import re
from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Locator, Page, Request, Route, expect

from tests.e2e.editor import wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

CURVE = "Spreadsheet (.csv)"
HELD = re.compile("focus-curve.*format=csv")
THIRDS = (0.7, 0.8, 0.9, 1, 1.1, 1.2, 1.4, 1.6, 1.8, 2, 2.2, 2.5, 2.8, 3.2, 3.5, 4, 4.5, 5, 5.6, 6.3, 7.1, 8, 9, 10, 11)
GLASS = 0.64
"""Share of the light that passes: T is 1.25 times f."""


@pytest.fixture
def held(page: Page) -> Iterator[list[Route]]:
    """Requests for spreadsheets, which the service never sees."""
    routes: list[Route] = []
    page.route(HELD, lambda route: routes.append(route))  # a list's own method is no handler
    yield routes
    page.unroute(HELD)


def is_spreadsheet(request: Request) -> bool:
    return "format=csv" in request.url


def make_curve(page: Page) -> Locator:
    """Ask for a file that does not come, and return the words that say so."""
    page.get_by_role("button", name="Download").click()
    page.get_by_role("button", name=CURVE, exact=True).click()
    words = page.get_by_text(f"Making {CURVE}…")
    expect(words).to_be_visible()
    return words


def test_a_wait_is_stopped_by_its_button(page: Page, held: list[Route]) -> None:
    words = make_curve(page)
    with page.expect_event("requestfailed", is_spreadsheet):
        page.get_by_role("button", name=f"Stop making {CURVE}").click()
    expect(words).to_have_count(0)
    expect(page.get_by_role("button", name="Download")).to_be_enabled()
    expect(page.get_by_role("alert")).to_have_count(0)
    assert len(held) == 1


def test_a_wait_is_stopped_by_escape(page: Page, held: list[Route]) -> None:
    words = make_curve(page)
    with page.expect_event("requestfailed", is_spreadsheet):
        page.keyboard.press("Escape")
    expect(words).to_have_count(0)
    expect(page.get_by_role("button", name="Download")).to_be_enabled()
    assert len(held) == 1


def test_a_poster_stands_for_a_shot_that_is_opened(page: Page) -> None:
    page.locator("[data-reading=near]").wait_for(state="attached")
    wait_settled(page, time=1)
    page.wait_for_function("() => localStorage.getItem('pullfocus.posters') !== null")
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


def test_one_stop_by_mouse_and_what_sets_the_brightness(lens: Page) -> None:
    number = lens.get_by_role("textbox", name="f-number")
    slider = lens.get_by_role("slider", name="f-number").bounding_box()
    assert slider is not None
    x, y = slider["x"], slider["y"] + slider["height"] / 2
    seen = set()
    lens.mouse.move(x + 0.2 * slider["width"], y)
    lens.mouse.down()
    for share in (0.2, 0.33, 0.41, 0.47, 0.59, 0.66):
        lens.mouse.move(x + share * slider["width"], y)
        seen.add(float(number.input_value().removeprefix("f/")))
    assert len(seen) > 3
    assert seen <= set(THIRDS)
    lens.keyboard.down("Alt")
    for share in (0.62, 0.61, 0.605):
        lens.mouse.move(x + share * slider["width"], y)
        seen.add(float(number.input_value().removeprefix("f/")))
    lens.mouse.up()
    lens.keyboard.up("Alt")
    assert not seen <= set(THIRDS)

    lens.keyboard.press("c")
    line = lens.locator(".brightness")
    expect(line).to_have_text("Brightness: as the scene is lit, glass −0.6 stops.")
    line.get_by_role("button", name="glass −0.6 stops").click()
    expect(lens.get_by_role("textbox", name="Passes")).to_be_focused()
