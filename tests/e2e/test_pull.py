"""A click means "from here on": the focus holds before, goes over in some frames, and holds after."""

from __future__ import annotations

import re

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.editor import FAR, NEAR, focus_points, revision_of, wait_edited, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

FRAME, HELD = 30, 44
"""The frame of the click; the demo's focus goes from the one to the other subject from frame 44 on."""
TABLE = 0.89, 0.52
"""A place on a table, which no focus point is on."""


def distances(service: str) -> dict[int, float]:
    """Return the focus distances of the demo by frame, metres."""
    answer = httpx.get(f"{service}/v1/shots/demo/focus-curve", params={"format": "json"}, timeout=120)
    return {round(row["timeCode"]): row["focusDistanceM"] for row in answer.raise_for_status().json()["samples"]}


def test_a_click_holds_before_and_after(page: Page, service: str) -> None:
    page.goto(f"/?shot=demo&time={FRAME}")
    wait_settled(page, time=FRAME)
    before, revision = distances(service), revision_of(page)
    box = page.locator(".picture").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + TABLE[0] * box["width"], box["y"] + TABLE[1] * box["height"])
    page.mouse.down()
    times = page.locator(".pull-times")
    expect(times).to_have_attribute("data-start", "18")  # before the button is released
    expect(times).to_have_attribute("data-arrival", str(FRAME))
    expect(times).to_have_attribute("data-held", str(HELD))
    page.mouse.up()
    wait_edited(page, revision)
    after = distances(service)
    (table,) = focus_points(service, FRAME).keys() - {NEAR, FAR}
    for frame in range(1, 19):
        assert after[frame] == pytest.approx(before[frame], rel=1e-6)
    for frame in range(FRAME, HELD + 1):
        assert after[frame] == pytest.approx(focus_points(service, frame)[table]["depthM"], rel=1e-3)
    table_m, near_m = (focus_points(service, 24)[name]["depthM"] for name in (table, NEAR))
    assert after[24] == pytest.approx(2 / (1 / table_m + 1 / near_m), rel=1e-4)  # half of the way, as the ring turns
    assert after[66] == pytest.approx(before[66], rel=1e-6)

    expect(page.locator(".pull-choice")).to_contain_text(f"Focus on {table}, from frame ")
    revision = revision_of(page)
    page.get_by_label("Length of the pull").fill("24")
    page.keyboard.press("Enter")
    wait_edited(page, revision)
    expect(times).to_have_attribute("data-start", "6")
    wider = distances(service)
    assert wider[6] == pytest.approx(before[6], rel=1e-6)
    assert wider[18] > 1.1 * before[18]
    assert wider[FRAME] == pytest.approx(after[FRAME], rel=1e-6)

    revision = revision_of(page)
    page.keyboard.press("Control+z")  # the click with its change is one step
    wait_edited(page, revision)
    assert distances(service) == pytest.approx(before, rel=1e-9)


def test_a_key_pulls_for_the_whole_shot(page: Page, service: str) -> None:
    page.goto(f"/?shot=demo&time={FRAME}")
    wait_settled(page, time=FRAME)
    before, revision = distances(service), revision_of(page)
    page.get_by_label("For how long").focus()
    page.keyboard.press("ArrowDown")
    expect(page.get_by_label("For how long")).to_have_value("shot")
    page.keyboard.press("Escape")
    page.evaluate("() => document.activeElement.blur()")
    selected = page.get_by_role("button", name=re.compile(f"Focus point {FAR}"))
    for _ in range(2):
        if selected.get_attribute("aria-pressed") != "true":
            page.keyboard.press("]")
    page.keyboard.press("f")
    revision = wait_edited(page, revision)
    after = distances(service)
    for frame in (1, FRAME, 96):
        assert after[frame] == pytest.approx(focus_points(service, frame)[FAR]["depthM"], rel=1e-6)
    page.keyboard.press("Control+z")
    wait_edited(page, revision)
    assert distances(service) == pytest.approx(before, rel=1e-9)
