"""Pictures of the page for the guide: its states, in windows from a wide screen to a phone.

.venv/bin/python -m tests.bench.page_pictures docs/images http://127.0.0.1:8000
"""

from __future__ import annotations

import argparse
from pathlib import Path

from playwright.sync_api import Browser, Page

from service.bench.page.browser import running_browser
from tests.bench.page_states import STATES
from tests.e2e.axe import violations

SIZES = {1920: 1080, 1440: 900, 1024: 768, 390: 844}
"""Width and height of the windows, CSS px. The narrowest one is a phone."""
PHONE = 390
QUALITY = 76
PATIENCE_MS = 600_000


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


def main() -> None:
    """Take the pictures of all states in all windows, and tell what axe-core finds in them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("address", help="of a service with the demo shot")
    parser.add_argument("--state", action="append", choices=STATES, help="only this one; may come again")
    parser.add_argument("--width", action="append", type=int, choices=SIZES, help="only windows of it; may come again")
    arguments = parser.parse_args()
    with running_browser(None) as browser:
        for width in arguments.width or SIZES:
            for state in arguments.state or STATES:
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
