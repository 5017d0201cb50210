"""Pictures of the page for the guide: its states, in windows from a wide screen to a phone.

.venv/bin/python -m tests.bench.page_pictures docs/images http://127.0.0.1:8000
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Browser, Page

from service.bench.page.browser import running_browser

SIZES = {1920: 1080, 1440: 900, 1024: 768, 390: 844}
"""Width and height of the windows, CSS px. The narrowest one is a phone."""
PHONE = 390
QUALITY = 82
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


STATES: dict[str, Callable[[Page], None]] = {
    "open": lambda page: None,
    "camera": show_camera,
    "commands": show_commands,
    "sharpness": show_sharpness,
    "curve": show_curve,
}


def main() -> None:
    """Take the pictures: each window with the shot open, and each state in windows of 1440 and of 390 px."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("address", help="of a service with the demo shot")
    arguments = parser.parse_args()
    with running_browser(None) as browser:
        for width in SIZES:
            for state in STATES if width in {1440, PHONE} else ["open"]:
                take(browser, arguments.address, width, state, arguments.folder)


def take(browser: Browser, address: str, width: int, state: str, folder: Path) -> None:
    """Take the picture of a state in a window, as a JPEG file of the folder."""
    page = browser.new_page(viewport={"width": width, "height": SIZES[width]}, has_touch=width == PHONE)
    page.set_default_timeout(PATIENCE_MS)
    page.goto(f"{address}/?shot=demo&time=48")
    page.locator("canvas[data-settled=true]").wait_for()
    page.locator(".focus-line").wait_for()
    STATES[state](page)
    page.locator("canvas[data-settled=true]").wait_for()
    page.wait_for_timeout(500)
    page.screenshot(path=folder / f"page_{state}_{width}.jpg", type="jpeg", quality=QUALITY)
    page.close()


if __name__ == "__main__":
    main()
