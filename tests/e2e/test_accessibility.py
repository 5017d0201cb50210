"""axe-core on the states of the page, the commands by keyboard, and narrow windows."""

from __future__ import annotations

import pytest
from playwright.sync_api import Browser, Page, ViewportSize, expect

from tests.bench.page_states import STATES
from tests.e2e.axe import violations
from tests.e2e.conftest import PATIENCE_MS
from tests.e2e.editor import FAR, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

PHONE: ViewportSize = {"width": 390, "height": 844}
WIDE: ViewportSize = {"width": 1280, "height": 640}  # with room for the menus


def test_axe_finds_nothing_in_any_state(page: Page) -> None:
    page.set_viewport_size(WIDE)
    wait_settled(page, time=1)
    page.locator(".focus-line").wait_for()
    assert violations(page) == []
    for menu in ("Shot", "Focus", "View"):
        page.get_by_role("menuitem", name=menu, exact=True).click()
        assert violations(page) == []
        page.keyboard.press("Escape")
    for keys, shown in (("Control+k", "All commands"), ("?", "Keys and clicks")):
        page.keyboard.press(keys)
        page.get_by_role("dialog", name=shown).wait_for()
        assert violations(page) == []
        page.keyboard.press("Escape")
    page.keyboard.press("c")
    page.get_by_role("heading", name="Exposure").wait_for()
    assert violations(page) == []
    page.keyboard.press("c")
    page.locator(".lane-key").nth(1).click()
    page.keyboard.press("t")
    page.locator(".graph").wait_for()
    wait_settled(page)
    assert violations(page) == []
    page.set_viewport_size(PHONE)
    page.locator(".knot").nth(1).click()
    page.locator(".handle").first.wait_for()
    assert violations(page) == []
    page.set_viewport_size(WIDE)
    wait_settled(page)
    page.get_by_role("combobox", name="Lens on the camera").click()
    assert violations(page) == []
    page.keyboard.press("Escape")
    for name in ("Playback", "Sharpness on the picture", "Download"):
        page.get_by_role("button", name=name).click()
        assert violations(page) == []
        page.keyboard.press("Escape")


def test_axe_finds_nothing_in_tools_on_a_phone(page: Page) -> None:
    page.set_viewport_size(PHONE)
    for state in ("scopes", "guides", "wipe", "top_view", "ring", "moving", "cameras", "renders"):
        page.evaluate("localStorage.clear()")
        page.reload()
        wait_settled(page, time=1)
        STATES[state](page)
        assert violations(page) == [], state


def test_a_command_is_found_and_done_by_typing(page: Page) -> None:
    wait_settled(page, time=1)
    page.keyboard.press("Control+k")
    search = page.get_by_role("combobox", name="Search in all commands")
    expect(search).to_be_focused()
    search.press_sequentially("last frame")
    page.keyboard.press("Enter")
    expect(page.get_by_role("dialog")).to_have_count(0)
    expect(page.get_by_role("slider", name="Frame")).to_have_attribute("aria-valuenow", "96")


def test_a_menu_is_walked_by_the_keyboard(page: Page) -> None:
    page.set_viewport_size(WIDE)
    wait_settled(page, time=1)
    page.get_by_role("menuitem", name="Shot", exact=True).focus()
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("ArrowDown")
    menu = page.get_by_role("menu", name="View")
    item = menu.get_by_role("menuitemcheckbox", name="Focus points on the picture")
    expect(item).to_have_attribute("aria-checked", "true")
    page.keyboard.press("ArrowRight")
    expect(page.get_by_role("menu", name="Shot")).to_be_visible()
    page.keyboard.press("ArrowLeft")
    for _ in range(10):
        if item.evaluate("item => item === document.activeElement"):
            break
        page.keyboard.press("f")
    expect(item).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.locator(".marker")).to_have_count(0)
    page.keyboard.press("m")
    expect(page.locator(".marker")).to_have_count(2)


def test_space_plays_after_a_click_on_a_button(page: Page) -> None:
    wait_settled(page, time=1)
    markers = page.get_by_role("button", name="Show focus points on the picture")
    markers.click()
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Pause")).to_be_visible()
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Play", exact=True)).to_be_visible()
    expect(markers).to_have_attribute("aria-pressed", "false")
    page.keyboard.press("m")


def test_panels_fold_and_resize_and_stay_so(page: Page) -> None:
    wait_settled(page, time=1)
    page.keyboard.press("Shift+Digit7")
    shots = page.get_by_role("navigation", name="Shots")
    expect(shots).to_have_count(0)
    settings = page.locator(".inspector")
    before = settings.bounding_box()
    assert before is not None
    page.get_by_role("separator", name="Width of the settings").focus()
    page.keyboard.press("ArrowLeft")
    page.reload()
    wait_settled(page, time=1)
    expect(shots).to_have_count(0)
    after = settings.bounding_box()
    assert after is not None
    assert after["width"] == pytest.approx(before["width"] + 16, abs=1)
    page.keyboard.press("Shift+Digit7")
    expect(shots).to_be_visible()


@pytest.mark.parametrize(("width", "height", "touch"), [(1024, 768, False), (720, 450, False), (390, 844, True)])
def test_everything_is_reached_in_a_narrow_window(
    browser: Browser, service: str, width: int, height: int, touch: bool
) -> None:
    size: ViewportSize = {"width": width, "height": height}
    page = browser.new_page(base_url=service, viewport=size, device_scale_factor=0.5, has_touch=touch)
    page.set_default_timeout(PATIENCE_MS)
    expect.set_options(timeout=PATIENCE_MS)
    page.goto("/?shot=demo&time=1")
    wait_settled(page, time=1)
    page.locator(".focus-line").wait_for()
    assert violations(page) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    for control in (
        page.get_by_role("button", name="Play", exact=True),
        page.get_by_role("slider", name="Frame"),
        page.get_by_role("button", name="Sharpness on the picture"),
        page.get_by_role("textbox", name="Focus distance"),
        page.get_by_role("slider", name=f"Weight of {FAR}"),
    ):
        control.scroll_into_view_if_needed()
        expect(control).to_be_in_viewport()
    page.get_by_role("button", name="All commands").click()
    page.get_by_role("combobox", name="Search in all commands").fill("curve and keys")
    page.keyboard.press("Enter")
    expect(page.locator(".lanes")).to_have_count(0)
    if width < 900:
        page.get_by_role("group", name="Panels").get_by_role("button", name="Shots").click()
        expect(page.get_by_role("navigation", name="Shots").get_by_role("button").first).to_be_focused()
        wait_settled(page, time=1)
        assert violations(page) == []
        page.keyboard.press("Escape")
        expect(page.get_by_role("navigation", name="Shots")).to_have_count(0)
    page.close()
