"""Cameras of a shot side by side, in a real browser, by the keyboard alone."""

from __future__ import annotations

import re
from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.axe import violations
from tests.e2e.editor import wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

STAGE = """#usda 1.0
(
    metersPerUnit = 1
    upAxis = "Y"
    startTimeCode = 1
    endTimeCode = 2
)
def Camera "front"
{
    double3 xformOp:translate = (0, 0, 20)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Camera "side"
{
    double3 xformOp:translate = (20, 0, 0)
    double xformOp:rotateY = 90
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateY"]
}
def Cube "bar"
{
    double3 xformOp:scale = (3, 1, 1)
    uniform token[] xformOpOrder = ["xformOp:scale"]
}
"""
LIT_COLUMNS = """(camera) => {
  const picture = document.querySelector(`[data-camera="${camera}"] img`);
  const canvas = new OffscreenCanvas(picture.naturalWidth, picture.naturalHeight);
  const context = canvas.getContext("2d");
  context.drawImage(picture, 0, 0);
  const { data } = context.getImageData(0, canvas.height >> 1, canvas.width, 1);
  return data.filter((_, at) => at % 4 === 1).filter((green) => green > 40).length / canvas.width;
}"""
"""Share of the columns of a camera's picture in which its middle row shows something."""


@pytest.fixture
def two_cameras(page: Page, service: str) -> Iterator[Page]:
    """The editor on a shot with two cameras."""
    answer = httpx.post(f"{service}/v1/shots", files={"file": ("bar.usda", STAGE)}, timeout=120)
    shot = answer.raise_for_status().json()["id"]
    page.goto(f"/?shot={shot}")
    wait_settled(page)
    yield page
    httpx.delete(f"{service}/v1/shots/{shot}", timeout=120).raise_for_status()


def test_cameras_are_seen_side_by_side_and_chosen(two_cameras: Page) -> None:
    page = two_cameras
    page.keyboard.press("Alt+Shift+C")
    dialog = page.get_by_role("dialog", name="Cameras at frame 1")
    expect(dialog.get_by_role("status")).to_have_attribute("data-drawn", "2")
    for camera in ("/front", "/side"):
        page.wait_for_function(
            "(camera) => document.querySelector(`[data-camera='${camera}'] img`)?.complete", arg=camera
        )
    assert page.evaluate(LIT_COLUMNS, "/front") > 2 * page.evaluate(LIT_COLUMNS, "/side") > 0
    expect(dialog.get_by_role("button", pressed=True)).to_have_count(0)  # the shot names none of the two
    assert violations(page) == []
    dialog.get_by_role("button", name="Look through side").focus()
    page.keyboard.press("Enter")
    expect(dialog).to_have_count(0)
    expect(page.get_by_label("Camera", exact=True)).to_have_value("/side")
    wait_settled(page)
    expect(page).to_have_url(re.compile("camera=/side|camera=%2Fside"))
