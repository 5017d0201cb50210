"""The page on a service that needs keys."""

from __future__ import annotations

import re
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.e2e.conftest import PATIENCE_MS, VIEWPORT
from tests.e2e.editor import revision_of, wait_edited, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The data folder of the service."""
    return tmp_path_factory.mktemp("locked")


def pullfocus(*words: str) -> list[str]:
    """Return a command line of this checkout."""
    return [sys.executable, "-m", "render.cli", *words]


@pytest.fixture(scope="module")
def keys(data: Path) -> dict[str, str]:
    """A key of each of two roles."""
    made = {}
    for label, role in (("Nora", "artist"), ("Rita", "reader")):
        command = pullfocus("keys", "create", label, "--role", role, "--data", str(data))
        said = subprocess.check_output(command, text=True)
        made[role] = re.search(r"pf_[\w-]+", said)[0]  # type: ignore[index]  # it prints the key
    return made


@pytest.fixture(scope="module")
def locked(data: Path, keys: dict[str, str]) -> Iterator[str]:
    """Address of a running service that needs keys."""
    command = pullfocus("serve", "--port", "0", "--require-keys", "--data", str(data))
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        log = iter(process.stderr)
        try:
            said = next(line for line in log if "http://" in line)
            threading.Thread(target=deque, args=(log, 0), daemon=True).start()
            yield re.search(r"http://[^/ ]+", said)[0]  # type: ignore[index]  # the line has one
        finally:
            process.terminate()
            process.wait(60)


@pytest.fixture
def page(browser: Browser, locked: str) -> Iterator[Page]:
    """The page of somebody who is not signed in, at a frame of the demo shot."""
    page = browser.new_page(base_url=locked, viewport=VIEWPORT, device_scale_factor=0.5)
    page.set_default_timeout(PATIENCE_MS)
    expect.set_options(timeout=PATIENCE_MS)
    page.goto("/?shot=demo&time=12")
    yield page
    page.close()


def sign_in(page: Page, key: str) -> None:
    """Send a key from the dialog."""
    page.get_by_role("textbox", name="Key", exact=True).fill(key)
    page.keyboard.press("Enter")


def test_who_signs_in_goes_on_where_the_page_was(page: Page, keys: dict[str, str]) -> None:
    key = keys["artist"]
    dialog = page.get_by_role("dialog", name="Sign in")
    expect(page.get_by_role("textbox", name="Key", exact=True)).to_be_focused()
    sign_in(page, "pf_wrong")
    expect(dialog.get_by_role("alert")).to_have_text("The key is wrong, expired or revoked.")
    sign_in(page, key)
    wait_settled(page, time=12)
    assert key not in page.evaluate("JSON.stringify([{...localStorage}, {...sessionStorage}, document.cookie])")

    # The session ends while she works: the edit waits for the key, and is made.
    page.context.clear_cookies()
    revision = revision_of(page)
    stop = page.get_by_role("textbox", name="f-number")
    stop.fill("8")
    stop.press("Enter")
    expect(dialog).to_contain_text("goes on where it was")
    sign_in(page, key)
    wait_edited(page, revision)
    expect(stop).to_have_value("f/8")

    page.get_by_role("button", name="Signed in as Nora").click()
    page.get_by_role("button", name="Sign out").click()
    expect(dialog).to_be_visible()
    expect(page.locator("canvas")).to_have_count(0)


def test_who_may_only_read_is_offered_no_edits(page: Page, keys: dict[str, str]) -> None:
    sent: list[str] = []
    sign_in(page, keys["reader"])
    reason = "Rita may look at shots, not edit."
    expect(page.get_by_role("note")).to_have_text(reason)
    expect(page.locator(".no-picture")).to_have_text("Rita may look at shots, not draw pictures.")
    expect(page.get_by_role("textbox", name="f-number")).to_be_disabled()
    for name in ("Add a shot", re.compile("^Remove Demo")):
        button = page.get_by_role("button", name=name)
        expect(button).to_be_disabled()
        expect(button).to_have_attribute("title", reason)
    page.on("request", lambda request: request.method != "GET" and sent.append(request.url))
    page.locator("canvas").click()
    page.keyboard.press("]")
    page.keyboard.press("Delete")
    expect(page.get_by_role("alert")).to_contain_text(reason)
    assert sent == []
