"""Notes and drawings at a frame: written and drawn on the page, kept in the shot, seen by others."""

from __future__ import annotations

import httpx
import pytest
from playwright.sync_api import Browser, Page, expect

from tests.e2e.axe import violations
from tests.e2e.conftest import PATIENCE_MS
from tests.e2e.editor import is_edit, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

WORDS = "Hold until she turns."


@pytest.fixture(autouse=True)
def clean(service: str) -> None:
    """Delete the notes of tests before."""
    notes = httpx.get(f"{service}/v1/shots/demo/notes", timeout=120).raise_for_status().json()["notes"]
    changes = [{"type": "deleteNote", "id": note["id"]} for note in notes]
    if changes:
        httpx.post(f"{service}/v1/shots/demo/edits", json={"changes": changes}, timeout=120).raise_for_status()


def draw(page: Page) -> None:
    """Draw a line over the picture."""
    box = page.locator(".drawing-sheet").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + 0.2 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.3 * box["height"])
    page.mouse.up()


def test_a_note_by_keyboard_is_kept_and_seen_by_others(
    page: Page, browser: Browser, service: str, pixel_ratio: float
) -> None:
    wait_settled(page, time=1)
    other = browser.new_page(base_url=service, device_scale_factor=pixel_ratio)
    other.set_default_timeout(PATIENCE_MS)
    other.goto("/?shot=demo&time=1")
    wait_settled(other, time=1)
    page.keyboard.press("Alt+n")
    expect(page.get_by_role("textbox", name="Note")).to_be_focused()
    page.keyboard.type(WORDS)
    assert violations(page) == []
    page.keyboard.press("Control+Enter")
    flag = "[data-flag='1']"
    page.locator(flag).wait_for(state="attached")
    other.locator(flag).wait_for(state="attached")
    other.close()
    expect(page.locator(".note-text")).to_have_text(WORDS)
    page.reload()
    wait_settled(page, time=1)
    page.keyboard.press("Alt+Shift+n")
    expect(page.locator(".note-text")).to_have_text(WORDS)
    page.keyboard.press("Alt+y")
    page.locator(".note.resolved").wait_for()
    assert violations(page) == []
    page.get_by_role("button", name="Delete the note at frame 1").click()
    page.locator(flag).wait_for(state="detached")
    page.keyboard.press("Control+z")
    page.locator(flag).wait_for(state="attached")


def test_a_drawing_is_on_the_picture_of_its_frame(page: Page) -> None:
    wait_settled(page, time=1)
    page.keyboard.press("Alt+p")
    expect(page.get_by_role("textbox", name="Note")).to_be_focused()
    page.keyboard.press("Tab")  # out of the text, so that the keys are those of the picture
    for _ in range(2):
        draw(page)
    strokes = page.locator(".drawings[data-strokes='2']")
    strokes.wait_for()
    page.keyboard.press("Control+z")
    page.locator(".drawings[data-strokes='1']").wait_for()
    with page.expect_response(is_edit):
        page.keyboard.press("Control+Enter")
    page.locator("[data-flag='1']").wait_for(state="attached")
    page.reload()
    wait_settled(page, time=1)
    page.locator(".drawings[data-strokes='1'] .ink-red").wait_for()
    page.keyboard.press("ArrowRight")
    wait_settled(page, time=2)
    expect(page.locator(".drawings")).to_have_count(0)
    page.keyboard.press("Alt+,")
    wait_settled(page, time=1)
    page.locator(".drawings[data-strokes='1']").wait_for()
