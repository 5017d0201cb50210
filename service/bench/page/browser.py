"""The browser of the page bench: Chromium, driven by Playwright, which is installed for benches and tests alone."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from render.errors import PullfocusError
from service.bench.page.plan import PagePlan

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

NAMES = ("chromium", "chromium-browser", "google-chrome")
PATIENCE_S = 600.0
"""Longest wait for anything: what is slow is measured, not given up."""
_PROBE = Path(__file__).with_name("probe.js")
_NO_PLAYWRIGHT = "the page bench needs Playwright, which is not installed: run `pip install playwright`"


@contextmanager
def running_browser(path: str | None) -> Iterator[Browser]:
    """Run a Chromium without a window until the end of the context.

    Args:
        path: of its program; None for the one that is found on the search path, or else Playwright's own.

    Raises:
        PullfocusError: there is no Playwright or no Chromium, or the page does not do in time what the bench waits for.
    """
    try:
        from playwright.sync_api import Error, sync_playwright
    except ImportError as error:
        raise PullfocusError(_NO_PLAYWRIGHT) from error
    with sync_playwright() as playwright:
        try:
            browser = playwright.chromium.launch(executable_path=path or installed())
        except Error as error:
            raise PullfocusError(
                "the page bench needs Chromium, which does not start: install the package chromium of the system, run "
                f"`playwright install chromium`, or name it by --browser PATH ({_first_line(error)})"
            ) from error
        try:
            yield browser
        except Error as error:
            raise PullfocusError(f"the page of the bench does not do what is expected: {_first_line(error)}") from error
        finally:
            browser.close()


@contextmanager
def fresh_page(browser: Browser, port: int, plan: PagePlan, *, probed: bool = True) -> Iterator[Page]:
    """Make a page in a browser context that knows nothing of the service, until the end of the context.

    Args:
        browser: it belongs to.
        port: of the service.
        plan: size of the window.
        probed: whether `probe.js` measures in it.
    """
    context = browser.new_context(
        base_url=f"http://127.0.0.1:{port}",
        viewport={"width": plan.width, "height": plan.height},
        device_scale_factor=plan.pixel_ratio,
    )
    try:
        page = context.new_page()
        page.set_default_timeout(1000 * PATIENCE_S)
        if probed:
            page.add_init_script(path=_PROBE)
        yield page
    finally:
        context.close()


def open_demo(page: Page, time: float) -> None:
    """Open the demo shot at a frame and wait for its best picture."""
    page.goto(f"/?shot=demo&time={time:g}")
    wait_settled(page)


def wait_settled(page: Page) -> None:
    """Wait until the best picture of the present state is on screen."""
    page.wait_for_selector("canvas[data-settled=true]")


def installed() -> str | None:
    """Return the path of the Chromium on the search path, or None."""
    return next(filter(None, map(shutil.which, NAMES)), None)


def _first_line(error: Exception) -> str:
    return str(error).strip().partition("\n")[0]
