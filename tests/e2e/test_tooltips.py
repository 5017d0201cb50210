"""Titles of controls, shown by the page for the pointer and for the keyboard."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from tests.e2e.axe import violations
from tests.e2e.editor import revision_of, tab_to, wait_edited, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]


def test_a_title_shows_while_the_pointer_is_on_a_control(page: Page) -> None:
    wait_settled(page, time=1)
    tip, markers = page.locator(".tooltip"), page.get_by_role("button", name="Show focus points on the picture")
    markers.hover()
    expect(tip).to_have_text("Show focus points (M)")
    box, at = tip.bounding_box(), markers.bounding_box()
    assert box
    assert at
    assert at["y"] + at["height"] <= box["y"] <= at["y"] + at["height"] + 12
    assert violations(page) == []
    page.keyboard.press("Escape")
    expect(tip).to_have_count(0)
    page.mouse.move(0, 0)
    expect(markers).to_have_attribute("title", "Show focus points (M)")  # read aloud, and shown by no browser meanwhile


def test_a_title_that_changes_is_the_new_one(page: Page) -> None:
    wait_settled(page, time=1)
    undo = page.locator('button[aria-label^="Undo"], button[aria-label="Nothing to undo"]')
    expect(page.locator(".marker")).to_have_count(2)
    undo.hover()
    expect(page.locator(".tooltip")).to_have_text("Nothing to undo (Ctrl Z)")
    revision = revision_of(page)
    page.keyboard.press("x")
    page.keyboard.press("f")
    wait_edited(page, revision)
    expect(page.locator(".tooltip")).to_contain_text("Undo: Focus on ")
    revision = revision_of(page)
    page.keyboard.press("Control+z")
    wait_edited(page, revision)
    page.mouse.move(0, 0)
    expect(undo).to_have_attribute("title", "Nothing to undo (Ctrl Z)")


def test_a_title_shows_for_the_keyboard(page: Page) -> None:
    wait_settled(page, time=1)
    tab_to(page, page.get_by_role("button", name="Keys and clicks"))
    expect(page.locator(".tooltip")).to_have_text("Keys and clicks (?)")
    page.keyboard.press("ArrowRight")
    expect(page.locator(".tooltip")).to_have_count(0)
