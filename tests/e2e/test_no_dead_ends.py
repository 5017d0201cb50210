"""A shot that lacks something, in a real browser: the page offers the next step."""

from __future__ import annotations

import io
import itertools
import re
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.conftest import VIEWPORT
from tests.e2e.editor import click_on, download, revision_of, shown_picture, wait_edited, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

CARDS = """#usda 1.0
(
    metersPerUnit = 1
    upAxis = "Y"
    startTimeCode = 1
    endTimeCode = 24
)

def Mesh "near"
{
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(-2, -1, 0), (0, -1, 0), (0, 1, 0), (-2, 1, 0)]
    color3f[] primvars:displayColor = [(0.8, 0.3, 0.1)]
}

def Mesh "far"
{
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(0, -1, -2), (2, -1, -2), (2, 1, -2), (0, 1, -2)]
    color3f[] primvars:displayColor = [(0.1, 0.3, 0.8)]
}
"""


@pytest.fixture(autouse=True)
def clean(service: str) -> Iterator[None]:
    """Remove the shots that a test has sent."""
    yield
    for shot in httpx.get(f"{service}/v1/shots", timeout=120).json()["shots"]:
        if shot["id"] != "demo":
            httpx.delete(f"{service}/v1/shots/{shot['id']}", timeout=120).raise_for_status()


def send(page: Page, name: str, content: bytes) -> None:
    """Send a file by the page's own button."""
    page.get_by_label("File of a shot").first.set_input_files(
        {"name": name, "mimeType": "application/octet-stream", "buffer": content}
    )


def sent_shot(service: str) -> dict[str, Any]:
    """Return the shot that was sent, as the service has it."""
    shots = httpx.get(f"{service}/v1/shots", timeout=120).json()["shots"]
    (found,) = [shot["id"] for shot in shots if shot["id"] != "demo"]
    shot: dict[str, Any] = httpx.get(f"{service}/v1/shots/{found}", timeout=120).json()
    return shot


def check_top_bar(page: Page) -> None:
    """Check that nothing of the bar on top lies over its neighbour, in windows of several widths."""
    for width in (390, 640, 768, 900, 1024, 1280, 1366, 1440):
        page.set_viewport_size({"width": width, "height": VIEWPORT["height"]})
        boxes = page.evaluate("""() => [...document.querySelectorAll(".topbar :is(button, select, .muted)")]
          .map((part) => part.getBoundingClientRect()).filter(({ width }) => width > 0)
          .map(({ left, right }) => [left, right])""")
        assert all(right <= left + 1 for (_, right), (left, _) in itertools.pairwise(sorted(boxes))), width
    page.set_viewport_size(VIEWPORT)


def test_a_camera_is_created_by_mouse_and_focused(page: Page, service: str, tmp_path: Path) -> None:
    wait_settled(page)
    send(page, "cards.usda", CARDS.encode())
    expect(page.locator(".crumbs .shot-name")).to_have_text(re.compile("cards"))
    wait_settled(page)
    framed = shown_picture(page)
    click_on(page, (0.6, 0.5))
    expect(page.get_by_role("alert")).to_contain_text("There is no camera to focus.")

    check_top_bar(page)
    page.get_by_role("button", name="Create a camera from this view").first.click()
    expect(page.get_by_label("Camera", exact=True)).to_have_value("/main_cam")
    check_top_bar(page)
    expect(page.get_by_role("alert")).to_have_count(0)
    expect(page.get_by_role("textbox", name="f-number")).to_have_value("f/2.8")
    wait_settled(page)
    assert shown_picture(page).std() > 0.5 * framed.std()  # the cards are still there
    assert sent_shot(service)["defaultCamera"]["path"] == "/main_cam"

    revision = revision_of(page)
    click_on(page, (0.6, 0.5))
    wait_edited(page, revision)
    expect(page.locator(".marker")).to_have_count(1)
    address = f"{service}/v1/shots/{sent_shot(service)['id']}"
    (point,) = httpx.get(f"{address}/focus-points", params={"time": 1}, timeout=120).json()["focusPoints"]
    assert (point["name"], point["target"]) == ("far", ["/far"])
    readout = httpx.get(f"{address}/readout", params={"time": 1}, timeout=120).json()
    assert readout["focusDistanceM"] == pytest.approx(point["depthM"], rel=1e-3)
    text = download(page, "Edit layer (.usda)", tmp_path).read_text()
    assert 'def Camera "main_cam"' in text
    assert "focusPoint:far:" in text

    page.keyboard.press("Control+z")
    expect(page.locator(".marker")).to_have_count(0)
    page.get_by_role("button", name="Undo: Create a camera").click()
    expect(page.get_by_role("button", name="Create a camera from this view")).to_have_count(2)
    wait_settled(page)
    assert sent_shot(service)["cameras"] == []
    page.get_by_role("button", name="Redo: Create a camera").click()
    expect(page.get_by_label("Camera", exact=True)).to_have_value("/main_cam")
    wait_settled(page)
    expect(page.get_by_role("alert")).to_have_count(0)


def zipped(**stages: str) -> bytes:
    """Pack stages into a zip, by their names without a suffix."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for name, text in stages.items():
            archive.writestr(f"{name}.usda", text)
    return file.getvalue()


def test_the_stage_of_a_zip_is_chosen_by_keyboard(page: Page, service: str) -> None:
    wait_settled(page)
    send(page, "two.zip", zipped(cards=CARDS, other="#usda 1.0\n"))
    stages = page.get_by_role("group", name="Stages of two.zip")
    expect(stages.get_by_role("button")).to_have_text(["cards.usda", "other.usda"])
    assert len(httpx.get(f"{service}/v1/shots", timeout=120).json()["shots"]) == 1

    page.get_by_role("button", name="Dismiss two.zip").focus()
    page.keyboard.press("Tab")
    expect(stages.get_by_role("button", name="cards.usda")).to_be_focused()
    page.keyboard.press("Enter")
    expect(stages).to_have_count(0)
    expect(page.locator(".crumbs .shot-name")).to_have_text(re.compile("two"))
    wait_settled(page)
    shot = sent_shot(service)
    assert (shot["root"], shot["fileCount"]) == ("cards.usda", 2)
    expect(page.get_by_role("button", name="Create a camera from this view")).to_have_count(2)
