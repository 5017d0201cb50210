"""Framing guides, safe areas, mask and burn-ins on the picture: where they stand to a pixel, by mouse and keyboard."""

from __future__ import annotations

import re

import httpx
import pytest
from playwright.sync_api import Locator, Page, expect

from tests.e2e.axe import violations
from tests.e2e.editor import wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

ASPECT = 16 / 9
"""Width over height of the demo's picture; its place on the page is rounded to pixels."""

Box = tuple[float, float, float, float]


def box_of(place: Locator) -> Box:
    """Return left, top, width and height of an element in the window, px."""
    box = place.bounding_box()
    assert box is not None
    return box["x"], box["y"], box["width"], box["height"]


def middle_of(whole: Box, across: float, up: float) -> Box:
    """Return the box in the middle of another one that has these shares of its width and height."""
    left, top, width, height = whole
    return left + width * (1 - across) / 2, top + height * (1 - up) / 2, width * across, height * up


def guide_in(whole: Box, aspect: float) -> Box:
    """Return the largest box of a shape in the middle of the picture."""
    return middle_of(whole, min(1, aspect / ASPECT), min(1, ASPECT / aspect))


def pressed(page: Page, group: str) -> list[str]:
    return page.get_by_role("group", name=group).locator("[aria-pressed=true]").all_inner_texts()


def test_guides_and_safe_areas_are_where_they_belong(page: Page) -> None:
    page.evaluate(
        "localStorage.clear(); localStorage.setItem('pullfocus.guide', '2.39:1')"
    )  # as an earlier page kept it
    page.reload()
    canvas = wait_settled(page, time=1)
    expect(page.locator(".guide")).to_have_count(1)
    page.get_by_role("button", name="Tools on the picture").click()
    assert pressed(page, "Framing guides") == ["2.39:1"]
    page.get_by_role("group", name="Framing guides").get_by_role("button", name="1:1", exact=True).click()
    page.get_by_role("group", name="Marks").get_by_role("button", name="Action 93 %").click()
    whole = box_of(canvas)
    for name, aspect in (("2.39:1", 2.39), ("1:1", 1.0)):
        frame = page.locator(f'.guide[data-name="{name}"]')
        assert box_of(frame) == pytest.approx(guide_in(whole, aspect), abs=1)
        expect(frame).to_have_text(name)
    action = page.locator(".guide-safe[data-name=action]")
    assert box_of(action) == pytest.approx(middle_of(whole, 0.93, 0.93), abs=1)
    page.get_by_role("radio", name="Safe in smallest guide").click()
    inner = guide_in(whole, 1.0)
    assert box_of(page.locator(".guide-mask")) == pytest.approx(inner, abs=1)
    assert box_of(action) == pytest.approx(middle_of(inner, 0.93, 0.93), abs=1)
    assert violations(page) == []
    slider = page.get_by_role("slider", name="Mask outside of the smallest guide")
    slider.press("End")
    expect(slider).to_have_attribute("aria-valuetext", "100 %")
    assert "rgb(0, 0, 0)" in page.locator(".guide-mask").evaluate("mask => getComputedStyle(mask).boxShadow")
    page.reload()
    expect(page.locator(".guide")).to_have_count(2)
    assert page.locator(".guide-mask").get_attribute("style") is not None
    assert page.evaluate("localStorage.getItem('pullfocus.guide')") is None


def test_keys_switch_guides_and_marks(page: Page) -> None:
    page.evaluate("localStorage.clear()")
    page.reload()
    canvas = wait_settled(page, time=1)
    for name in ("2.39:1", "2:1"):
        page.keyboard.press("g")
        expect(page.locator(".guide")).to_have_text(name)
    page.keyboard.press("Alt+a")
    whole = box_of(canvas)
    assert box_of(page.locator(".guide-safe[data-name=title]")) == pytest.approx(middle_of(whole, 0.9, 0.9), abs=1)
    page.keyboard.press("Alt+h")
    page.keyboard.press("Alt+x")
    marks = page.get_by_role("img", name="Framing guides: 2:1, action, title, thirds, cross")
    expect(marks).to_be_visible()
    mask = page.locator(".guide-mask")
    for dark in ("0.75", "1", "0", "0.45"):
        page.keyboard.press("Shift+q")
        expect(mask).to_have_attribute("style", re.compile(rf"--dark: ?{dark};"))
    page.keyboard.press("Alt+a")
    expect(page.locator(".guide-safe")).to_have_count(0)


def test_burn_ins_go_with_the_picture(page: Page, service: str) -> None:
    page.evaluate("localStorage.clear()")
    page.reload()
    canvas = wait_settled(page, time=1)
    page.keyboard.press("Alt+b")
    corner = page.locator(".burnt.bottom-right")
    expect(corner).to_have_text("frame 1 · 00:00:00:01")
    whole, strip = box_of(canvas), box_of(corner)
    assert (strip[0] + strip[2], strip[1] + strip[3]) == pytest.approx(
        (whole[0] + whole[2], whole[1] + whole[3]), abs=1
    )
    page.keyboard.press("End")
    wait_settled(page, time=96)
    expect(corner).to_have_text("frame 96 · 00:00:04:00")
    readout = httpx.get(f"{service}/v1/shots/demo/readout", params={"time": 96}, timeout=120).raise_for_status().json()
    lens = page.locator(".burnt.top-right")
    expect(lens).to_contain_text(readout["lensName"])
    page.wait_for_function(
        """(focusM) => {
          const said = /focus ([\\d.]+) m/.exec(document.querySelector(".burnt.top-right").innerText);
          return said !== null && Math.abs(Number(said[1]) - focusM) < 0.01;
        }""",
        arg=readout["focusDistanceM"],
    )
    page.keyboard.press("u")
    expect(lens).to_contain_text("′")
    page.get_by_role("button", name="Tools on the picture").click()
    facts = page.get_by_role("group", name="Burn-ins", exact=True)
    facts.get_by_role("button", name="Timecode").click()
    expect(corner).to_have_text("frame 96")
    assert violations(page) == []
    page.keyboard.press("Escape")
    page.keyboard.press("Home")
    wait_settled(page, time=1)
    page.keyboard.press("l")
    # While it plays, the texts are those of the picture on screen, which may be behind the playhead.
    page.wait_for_function(
        """() => {
            const canvas = document.querySelector(".picture > canvas"), text = document.querySelector(".burnt.bottom-right");
            if (text.innerText !== `frame ${canvas.dataset.time}`) throw new Error(text.innerText + " " + canvas.dataset.time);
            return Number(canvas.dataset.time) > 1;
        }"""
    )
    page.keyboard.press("k")
