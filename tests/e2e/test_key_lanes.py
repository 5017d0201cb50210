"""The timeline's keys in a real browser: dragged, nudged, selected in a box, typed, removed and undone."""

from __future__ import annotations

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.e2e.editor import NEAR, focus_points, revision_of, scrub_to, wait_edited, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]


def test_a_key_is_dragged_to_a_frame_and_back_by_one_undo(page: Page, service: str) -> None:
    wait_settled(page)
    first, second, *others = weights(service)
    revision = revision_of(page)
    grab(page, key_at(page, second[0]), frames=-7.2)
    wait_edited(page, revision)
    assert weights(service) == [first, (second[0] - 7, second[1]), *others]
    expect(page.get_by_role("textbox", name="Frame of the keys")).to_have_value(f"{second[0] - 7:g}")

    page.keyboard.press("Control+z")
    wait_edited(page, revision + 1)
    assert weights(service) == [first, second, *others]


def test_the_keyboard_moves_a_key_and_keeps_hold_of_it(page: Page, service: str) -> None:
    wait_settled(page)
    before = weights(service)
    time, value = before[1]
    key_at(page, time).focus()
    revision = revision_of(page)
    for step in (1, 2):
        page.keyboard.press("ArrowRight")
        revision = wait_edited(page, revision)
        expect(page.locator(":focus")).to_have_attribute("data-stack", f"point {NEAR}@{time + step:g}")
    assert weights(service)[1] == (time + 2, value)
    for _ in range(2):
        page.keyboard.press("Control+z")
        revision = wait_edited(page, revision)
    assert weights(service) == before


def test_keys_in_a_box_are_edited_together(page: Page, service: str) -> None:
    wait_settled(page)
    before = focus_points(service, 1)
    lanes = page.get_by_role("group", name="Keys", exact=True).bounding_box()
    assert lanes is not None
    page.mouse.move(lanes["x"] + 105, lanes["y"] + 1)
    page.mouse.down()
    page.mouse.move(lanes["x"] + lanes["width"] - 60, lanes["y"] + 40)  # not down to the camera's lane
    page.mouse.up()
    expect(page.locator(".lane-key.selected")).to_have_count(4)

    revision = revision_of(page)
    page.get_by_role("combobox", name="Interpolation of the keys").select_option("Held")
    revision = wait_edited(page, revision)
    held = [key["interpolation"] for point in focus_points(service, 1).values() for key in point["keys"]["weight"]]
    assert held.count("held") == 4
    page.keyboard.press("Delete")
    revision = wait_edited(page, revision)
    assert sum(len(point["keys"]["weight"]) for point in focus_points(service, 1).values()) == 4
    for _ in range(2):
        page.keyboard.press("Control+z")
        revision = wait_edited(page, revision)
    after = focus_points(service, 1)
    assert {name: point["keys"] for name, point in after.items()} == {name: p["keys"] for name, p in before.items()}


def test_keys_are_copied_and_pasted_by_the_menu_and_the_keyboard(page: Page, service: str) -> None:
    wait_settled(page)
    before = weights(service)
    key_at(page, before[1][0]).click(button="right")
    menu = page.get_by_role("menu", name="Keys")
    expect(menu.get_by_role("menuitem", name="Paste at the playhead")).to_be_disabled()
    menu.get_by_role("menuitem", name="Copy").click()
    expect(menu).to_have_count(0)
    scrub_to(page, 30)
    revision = revision_of(page)
    page.keyboard.press("Control+v")
    revision = wait_edited(page, revision)
    assert [value for time, value in weights(service) if time == 30] == [before[1][1]]
    expect(page.locator(".lane-key.selected")).to_have_attribute("data-stack", f"point {NEAR}@30")

    key_at(page, 30).focus()
    page.keyboard.press("Shift+F10")
    expect(menu).to_be_visible()
    page.keyboard.press("End")
    page.keyboard.press("Enter")
    revision = wait_edited(page, revision)
    assert weights(service) == before
    for _ in range(2):
        page.keyboard.press("Control+z")
        revision = wait_edited(page, revision)
    assert weights(service) == before


def weights(service: str) -> list[tuple[float, float]]:
    """Return time and value of the weight keys of the near subject."""
    return [(key["time"], key["value"]) for key in focus_points(service, 1)[NEAR]["keys"]["weight"]]


def key_at(page: Page, time: float) -> Locator:
    """Return the near subject's key at a time."""
    return page.locator(f'[data-stack="point {NEAR}@{time:g}"]')


def grab(page: Page, key: Locator, frames: float) -> None:
    """Drag a key by a number of frames."""
    box, bed = key.bounding_box(), page.locator(".scrub-bed").bounding_box()
    assert box is not None
    assert bed is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + bed["width"] * frames / 2 / 95, y)
    page.mouse.move(x + bed["width"] * frames / 95, y)
    page.mouse.up()
