"""The rack of the demo is set up from nothing, and its softest subject is found and held, by the keyboard alone."""

from __future__ import annotations

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.editor import FAR, NEAR, focus_points, revision_of, tab_to, wait_edited, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

RACK = 60
"""Frame at which the focus arrives at the far subject."""


def aim(page: Page, at: tuple[float, float]) -> None:
    """Move the crosshair to a point of the picture, 0 to 1 from its top left corner, by the arrow keys."""
    tab_to(page, page.locator(".aim"))
    cross = page.locator(".cross")
    for edge, target, less, more in (
        ("left", at[0], "ArrowLeft", "ArrowRight"),
        ("top", at[1], "ArrowUp", "ArrowDown"),
    ):
        steps = round((target - cross.evaluate("(cross, edge) => parseFloat(cross.style[edge])", edge) / 100) / 0.01)
        for _ in range(abs(steps)):
            page.keyboard.press(more if steps > 0 else less)


def distance_at(service: str, frame: int) -> float:
    """Return the focus distance of the demo at a frame, metres."""
    answer = httpx.get(f"{service}/v1/shots/demo/focus-curve", params={"format": "json"}, timeout=120)
    samples = answer.raise_for_status().json()["samples"]
    return float(next(row["focusDistanceM"] for row in samples if round(row["timeCode"]) == frame))


def edit(page: Page, *keys: str) -> None:
    """Press keys of which the last one edits the shot, and wait for the picture after it."""
    revision = revision_of(page)
    for key in keys:
        page.keyboard.press(key)
    wait_edited(page, revision)


def test_a_rack_is_set_up_from_nothing_by_keyboard(page: Page, service: str) -> None:
    wait_settled(page, time=1)
    near, far = focus_points(service, 1)[NEAR], focus_points(service, RACK)[FAR]
    expect(page.locator(".marker")).to_have_count(2)
    for _ in range(2):
        edit(page, "]", "Delete")
    expect(page.locator(".marker")).to_have_count(0)
    aim(page, near["screen"])
    expect(page.locator(".probe")).to_contain_text(" m")  # with no overlay, too
    edit(page, "Enter")
    page.keyboard.press("Escape")
    page.keyboard.press("Home")
    for _ in range((RACK - 1) // 10):
        page.keyboard.press("Shift+ArrowRight")
    for _ in range((RACK - 1) % 10):
        page.keyboard.press("ArrowRight")
    wait_settled(page, time=RACK)
    aim(page, far["screen"])
    edit(page, "Enter")
    assert distance_at(service, 1) == pytest.approx(near["depthM"], rel=0.1)
    assert distance_at(service, RACK) == pytest.approx(far["depthM"], rel=0.1)
    assert near["depthM"] * 1.3 < distance_at(service, RACK - 5) < far["depthM"] / 1.3
    for _ in range(4):
        edit(page, "Control+z")
    assert set(focus_points(service, 1)) == {NEAR, FAR}


def test_the_softest_subject_is_found_and_held(page: Page, service: str) -> None:
    wait_settled(page, time=1)
    softest = page.get_by_role("button", name=f"Focus point {FAR}")
    softest.wait_for()
    page.keyboard.press("x")
    expect(softest).to_have_attribute("aria-pressed", "true")
    expect(softest).to_contain_text("soft")
    edit(page, "f")
    expect(softest).to_contain_text("sharp")
    assert focus_points(service, 1)[FAR]["sharp"] is True
    edit(page, "Control+z")
    expect(softest).to_contain_text("soft")
