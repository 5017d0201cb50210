"""Two browsers at one shot: each shows where the other is and its edits, none is lost, and a refused one can be made again."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress

import httpx
import pytest
from playwright.sync_api import Browser, Error, Locator, Page, Route, expect

from tests.e2e.axe import violations
from tests.e2e.conftest import PATIENCE_MS, VIEWPORT
from tests.e2e.editor import FAR, NEAR, click_on, focus_points, is_edit

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

FRAME = 40
STILL = "/?shot=demo&time=40"


@pytest.fixture
def pages(browser: Browser, service: str) -> Iterator[tuple[Page, Page]]:
    """The demo shot without edits, open in two browsers that share nothing; errors that a page does not catch fail the test."""
    edits = f"{service}/v1/shots/demo/edits"
    first = httpx.get(f"{edits}/history", timeout=120).raise_for_status().json()["steps"][0]["revision"]
    httpx.put(edits, json={"revision": first}, timeout=120).raise_for_status()
    uncaught: list[str] = []
    contexts = [browser.new_context(base_url=service, viewport=VIEWPORT, device_scale_factor=0.5) for _ in range(2)]
    opened = []
    for context in contexts:
        page = context.new_page()
        page.set_default_timeout(PATIENCE_MS)
        page.on("pageerror", lambda error: uncaught.append(str(error)))
        page.goto(STILL)
        opened.append(page)
    expect.set_options(timeout=PATIENCE_MS)
    for page in opened:
        page.locator("canvas[data-edits]").wait_for()
    yield opened[0], opened[1]
    for context in contexts:
        context.close()
    assert uncaught == []


def stop(page: Page) -> Locator:
    """Return the field of the f-number."""
    return page.get_by_role("textbox", name="f-number")


def row(page: Page, point: str) -> Locator:
    """Return the row of a focus point."""
    return page.locator(".point").filter(has=page.get_by_role("button", name=f"Remove {point}"))


def saved_stop(service: str) -> float:
    """Return the f-number that the service has."""
    told = httpx.get(f"{service}/v1/shots/demo/readout", params={"time": FRAME}, timeout=120).raise_for_status().json()
    return float(told["fStop"])


def choose_stop(page: Page, value: str) -> None:
    """Type an f-number."""
    stop(page).fill(value)
    stop(page).press("Enter")


def walk(page: Page, way: str) -> None:
    """Press the button that undoes or redoes the last edit."""
    page.get_by_role("button", name=re.compile(f"^{way}: ")).click()


def wait_heard(page: Page, service: str) -> None:
    """Wait until a page has read the edits that the shot has now."""
    told = httpx.get(f"{service}/v1/shots/demo/edits/history", timeout=120).raise_for_status().json()
    page.locator(f'canvas[data-edits="{told["revision"]}"]').wait_for()


def test_edits_by_turns_are_seen_by_the_other(pages: tuple[Page, Page], service: str) -> None:
    mine, other = pages
    for writer, reader, value in ((mine, other, "2.8"), (other, mine, "5.6"), (mine, other, "4")):
        choose_stop(writer, value)
        expect(stop(reader)).to_have_value(f"f/{value}")
        assert saved_stop(service) == pytest.approx(float(value))
        wait_heard(reader, service)
    walk(other, "Undo")
    expect(stop(mine)).to_have_value("f/5.6")
    expect(stop(other)).to_have_value("f/5.6")
    wait_heard(mine, service)
    walk(mine, "Redo")
    expect(stop(other)).to_have_value("f/4")


def test_points_come_and_go_beside_a_selection(pages: tuple[Page, Page], service: str) -> None:
    mine, other = pages
    row(other, FAR).locator(".point-name").click()
    expect(row(other, FAR)).to_have_class("point selected")
    mine.locator("canvas[data-stage]").wait_for()  # a click needs a picture
    mine.keyboard.press("Alt+2")
    click_on(mine, (0.5, 0.9))
    expect(other.locator(".point")).to_have_count(3)
    (added,) = set(focus_points(service, FRAME)) - {NEAR, FAR}
    expect(row(other, added)).to_be_visible()
    expect(row(other, FAR)).to_have_class("point selected")
    row(mine, NEAR).get_by_role("button", name=f"Remove {NEAR}").click()
    expect(other.locator(".point")).to_have_count(2)
    expect(row(other, FAR)).to_have_class("point selected")
    walk(mine, "Undo")
    expect(row(other, NEAR)).to_be_visible()
    expect(row(other, FAR)).to_have_class("point selected")


def test_edits_at_the_same_time_are_all_kept(pages: tuple[Page, Page], service: str) -> None:
    mine, other = pages
    for enabled in (False, True, False):  # of another point each, so that neither is in the other's way
        for page, point in ((mine, NEAR), (other, FAR)):
            row(page, point).get_by_role("checkbox", name=f"{point} enabled").click()
        for page in pages:
            for point in (NEAR, FAR):
                expect(page.get_by_role("checkbox", name=f"{point} enabled")).to_be_checked(checked=enabled)
        assert [focus_points(service, FRAME)[point]["enabled"] for point in (NEAR, FAR)] == [enabled, enabled]


def test_an_edit_that_came_too_late_is_offered_again(pages: tuple[Page, Page], service: str) -> None:
    mine, other = pages
    slider = mine.get_by_role("slider", name="f-number").bounding_box()
    assert slider is not None
    y = slider["y"] + slider["height"] / 2
    mine.mouse.move(slider["x"] + 0.3 * slider["width"], y)
    mine.mouse.down()
    mine.mouse.move(slider["x"] + 0.6 * slider["width"], y)
    tried = float(stop(mine).input_value().removeprefix("f/"))
    with other.expect_response(is_edit):
        choose_stop(other, "2.8")
    assert saved_stop(service) == pytest.approx(2.8)
    mine.mouse.up()
    told = mine.get_by_role("alert")
    expect(told).to_contain_text("Somebody else changed this meanwhile.")
    expect(stop(mine)).to_have_value("f/2.8")
    told.get_by_role("button", name="Try again").click()
    expect(told).to_have_count(0)
    expect(stop(other)).not_to_have_value("f/2.8")
    assert saved_stop(service) == pytest.approx(tried, rel=0.02)


def test_an_edit_of_a_deleted_point_is_offered_again(pages: tuple[Page, Page], service: str) -> None:
    mine, other = pages
    held: list[Route] = []
    mine.route("**/edits", lambda route: held.append(route))
    with mine.expect_request("**/edits"):
        row(mine, FAR).get_by_role("checkbox", name=f"{FAR} enabled").click()
    with other.expect_response(is_edit):
        row(other, FAR).get_by_role("button", name=f"Remove {FAR}").click()
    mine.unroute("**/edits")
    for route in held:
        with suppress(Error):  # one that went on by itself
            route.continue_()
    told = mine.get_by_role("alert")
    expect(told.get_by_role("button", name="Try again")).to_be_visible()
    expect(mine.locator(".point")).to_have_count(1)
    walk(other, "Undo")
    expect(other.locator(".point")).to_have_count(2)
    expect(mine.locator(".point")).to_have_count(2)
    told.get_by_role("button", name="Try again").click()
    expect(told).to_have_count(0)
    expect(row(other, FAR).get_by_role("checkbox", name=f"{FAR} enabled")).not_to_be_checked()
    assert focus_points(service, FRAME)[FAR]["enabled"] is False


def command(page: Page, words: str) -> None:
    """Do what a command of the list of all commands does, by keyboard."""
    page.keyboard.press("Control+k")
    page.get_by_role("combobox", name="Search in all commands").fill(words)
    page.keyboard.press("Enter")


def test_the_other_is_seen_to_move_and_is_gone_to(pages: tuple[Page, Page]) -> None:
    mine, other = pages
    row = mine.get_by_role("region", name="Also here").locator("li")
    expect(row).to_contain_text(f"Frame {FRAME}")
    other.get_by_role("slider", name="Frame").focus()
    for frame in (FRAME + 1, FRAME + 2):
        other.keyboard.press("ArrowRight")
        expect(row).to_contain_text(f"Frame {frame}")
        mine.locator(f".other-flags[data-at='{frame}']").wait_for(state="attached")
    other.keyboard.press("ArrowLeft")  # to a picture that it has kept
    expect(row).to_contain_text(f"Frame {FRAME + 1}")
    assert violations(mine) == []
    command(mine, "who else is here")
    expect(row.get_by_role("button")).to_be_focused()
    mine.keyboard.press("Enter")
    mine.locator(f"canvas[data-time='{FRAME + 1}']").wait_for()
    other.keyboard.press("Home")
    expect(row).to_contain_text("Frame 1")
    command(mine, "next person here")
    mine.locator("canvas[data-time='1']").wait_for()
    other.close()
    expect(mine.get_by_role("region", name="Also here")).to_have_count(0)


def test_a_note_that_both_edit_is_not_overwritten_unseen(pages: tuple[Page, Page]) -> None:
    mine, other = pages
    mine.keyboard.press("Alt+n")
    expect(mine.get_by_role("textbox", name="Note")).to_be_focused()
    mine.keyboard.type("As it was.")
    mine.keyboard.press("Control+Enter")
    other.keyboard.press("Alt+Shift+n")
    for page, words in ((mine, "Mine."), (other, "Theirs.")):
        page.get_by_role("button", name=f"Edit the note at frame {FRAME}").click()
        page.get_by_role("textbox", name="Note").fill(words)
    held: list[Route] = []
    mine.route("**/edits", lambda route: held.append(route))
    with mine.expect_request("**/edits"):
        mine.keyboard.press("Control+Enter")
    with other.expect_response(is_edit):
        other.keyboard.press("Control+Enter")
    mine.unroute("**/edits")
    for route in held:
        with suppress(Error):  # one that went on by itself
            route.continue_()
    told = mine.get_by_role("alert")
    expect(told).to_contain_text("Somebody else changed this meanwhile.")
    expect(mine.locator(".note-text")).to_have_text("Theirs.")
    expect(mine.get_by_role("textbox", name="Note")).to_have_value("Mine.")
    told.get_by_role("button", name="Try again").click()
    expect(told).to_have_count(0)
    for page in pages:
        expect(page.locator(".note-text")).to_have_text("Mine.")
