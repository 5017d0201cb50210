"""Pictures of the page for the guide: its states, in windows from a wide screen to a phone.

.venv/bin/python -m tests.bench.page_pictures docs/images http://127.0.0.1:8000
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Browser, Page

from service.bench.page.browser import running_browser
from tests.e2e.axe import violations

SIZES = {1920: 1080, 1440: 900, 1024: 768, 390: 844}
"""Width and height of the windows, CSS px. The narrowest one is a phone."""
PHONE = 390
QUALITY = 76
PATIENCE_MS = 600_000


def show_camera(page: Page) -> None:
    """Show the settings of camera and film."""
    page.keyboard.press("c")
    page.get_by_role("heading", name="Exposure").wait_for()


def show_commands(page: Page) -> None:
    """Open the list of all commands, with something typed."""
    page.keyboard.press("Control+k")
    page.get_by_role("combobox", name="Search in all commands").fill("key")


def show_sharpness(page: Page) -> None:
    """Select a point, and colour what is sharp."""
    page.keyboard.press("]")
    page.keyboard.press("Shift+Digit3")
    page.locator(".focus-legend .bar").wait_for()
    page.locator(".aim").focus()
    page.keyboard.press("Shift+ArrowRight")
    page.locator(".probe").wait_for()


def show_curve(page: Page) -> None:
    """Show the curve of a weight, with a key selected."""
    page.keyboard.press("t")
    page.locator(".knot").nth(1).click()
    page.locator(".handle").first.wait_for()


def show_groups(page: Page) -> None:
    """Give both points a colour and a group, which `take` undoes, and select the first one."""
    for name, color in (("pip", "teal"), ("mara", "orange")):
        point = page.locator(".point").filter(has=page.get_by_role("button", name=f"Remove {name}"))
        point.locator(".point-name").click()
        point.get_by_role("radio", name=color).click()
        wait_undoable(page, f"Colour {name} {color}")
        point.get_by_label("Group").fill("cast")
        point.get_by_label("Group").press("Enter")
        wait_undoable(page, f"Put {name} in cast")
    page.locator(".point-group").scroll_into_view_if_needed()


def wait_undoable(page: Page, label: str) -> None:
    """Wait until an edit is the last one; a phone has no button for it that is shown."""
    page.locator(f'button[aria-label="Undo: {label}"]').wait_for(state="attached")


def undo_label(page: Page) -> str | None:
    """Return what the next undo is called, None where there is none."""
    undo = page.locator('button[aria-label^="Undo: "]:enabled')
    return undo.get_attribute("aria-label") if undo.count() > 0 else None


def undo_to(page: Page, before: str | None) -> None:
    """Undo by the keyboard what a state has edited, until the next undo is called as before."""
    page.evaluate("document.activeElement.blur()")
    while (label := undo_label(page)) not in (None, before):
        page.keyboard.press("Control+z")
        page.locator(f'button[aria-label="{label}"]').wait_for(state="detached")


def show_lenses(page: Page) -> None:
    """Look for a lens."""
    box = page.get_by_role("combobox", name="Lens on the camera")
    box.scroll_into_view_if_needed()
    box.click()
    box.press_sequentially("planar")


STATES: dict[str, Callable[[Page], None]] = {
    "open": lambda page: None,
    "camera": show_camera,
    "commands": show_commands,
    "sharpness": show_sharpness,
    "curve": show_curve,
    "groups": show_groups,
    "lenses": show_lenses,
}


def main() -> None:
    """Take the pictures of all states in all windows, and tell what axe-core finds in them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("address", help="of a service with the demo shot")
    arguments = parser.parse_args()
    with running_browser(None) as browser:
        for width in SIZES:
            for state in STATES:
                for violation in take(browser, arguments.address, width, state, arguments.folder):
                    print(f"{state} at {width} px: {violation}")


def take(browser: Browser, address: str, width: int, state: str, folder: Path) -> list[str]:
    """Take the picture of a state in a window, as a JPEG file of the folder, and return what axe-core finds there."""
    page = browser.new_page(
        viewport={"width": width, "height": SIZES[width]}, has_touch=width == PHONE, bypass_csp=True
    )
    page.set_default_timeout(PATIENCE_MS)
    page.goto(f"{address}/?shot=demo&time=48")
    page.locator("canvas[data-settled=true]").wait_for()
    page.locator(".focus-line").wait_for()
    before = undo_label(page)
    STATES[state](page)
    page.locator("canvas[data-settled=true]").wait_for()
    page.wait_for_timeout(500)
    page.screenshot(path=folder / f"page_{state}_{width}.jpg", type="jpeg", quality=QUALITY)
    page.evaluate(
        "for (const each of document.querySelectorAll('*')) each.scrollTop = 0"
    )  # what is half hidden is small
    found = violations(page)
    undo_to(page, before)
    page.close()
    return found


if __name__ == "__main__":
    main()
