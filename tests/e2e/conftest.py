"""A real service with its demo shot, and a real browser."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect, sync_playwright

CHROMIUM = shutil.which("chromium")
# As small as the page goes, so that its pictures are small too: a software rasteriser draws them.
VIEWPORT = {"width": 900, "height": 560}
# Far more than any one step takes, and a busy machine is slow, not wrong.
PATIENCE_MS = 300_000


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a running service that has the demo shot."""
    folder = tmp_path_factory.mktemp("service")
    command = [sys.executable, "-m", "render.cli", "serve", "--port", "0", "--data", str(folder)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        log = iter(process.stderr)
        try:
            said = next(line for line in log if "http://" in line)
            # What it says from here on is read and dropped: a full pipe would stop it.
            threading.Thread(target=deque, args=(log, 0), daemon=True).start()
            yield re.search(r"http://[^/ ]+", said)[0]  # type: ignore[index]  # the line has one
        finally:
            process.terminate()
            process.wait(60)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Chromium without a window."""
    if CHROMIUM is None:
        pytest.skip("chromium is not installed")
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield chromium
        chromium.close()


@pytest.fixture
def pixel_ratio() -> float:
    """Device pixels to a pixel of the page. Pictures are as fine as the device shows; most tests need no fine ones."""
    return 0.5


@pytest.fixture
def page(browser: Browser, service: str, pixel_ratio: float) -> Iterator[Page]:
    """The editor, open on the demo shot at its first frame; an error that the page does not catch fails the test."""
    page = browser.new_page(base_url=service, viewport=VIEWPORT, device_scale_factor=pixel_ratio)
    page.set_default_timeout(PATIENCE_MS)
    expect.set_options(timeout=PATIENCE_MS)
    uncaught: list[str] = []
    page.on("pageerror", lambda error: uncaught.append(str(error)))
    page.on("console", lambda said: "Content Security Policy" in said.text and uncaught.append(said.text))
    page.goto("/?shot=demo&time=1")
    yield page
    page.close()
    assert uncaught == []
