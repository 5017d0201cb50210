"""Variants and payloads in a real browser, by the keyboard alone."""

from __future__ import annotations

import httpx
import numpy as np
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.axe import violations
from tests.e2e.editor import revision_of, shown_picture, wait_edited, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

STAGE = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
    upAxis = "Y"
)
def Camera "main_cam"
{
    double3 xformOp:translate = (0, 0, 20)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Cube "box"
{
    token visibility = "invisible"
}
def Xform "World"
{
    def Xform "toy" (
        variants = { string shape = "ball" }
        prepend variantSets = ["shape"]
    )
    {
        variantSet "shape" = {
            "ball" {
                def Sphere "it" {
                }
            }
            "gone" {
            }
        }
    }
    def "tram" (
        payload = </box>
    )
    {
        token visibility = "inherited"
        double3 xformOp:translate = (3, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
}
"""


@pytest.fixture
def toy(page: Page, service: str) -> Page:
    """The editor on a shot with a variant set and a payload."""
    sent = httpx.post(f"{service}/v1/shots", files={"file": ("toy.usda", STAGE.encode())}, timeout=120)
    page.goto(f"/?shot={sent.raise_for_status().json()['id']}&time=1")
    wait_settled(page)
    return page


def test_a_variant_and_a_payload_are_chosen_by_keyboard_alone(toy: Page) -> None:
    whole = shown_picture(toy)
    toy.keyboard.press("Alt+v")
    dialog = toy.get_by_role("dialog", name="Variants and payloads")
    shape = dialog.get_by_role("combobox", name="shape of /World/toy")
    expect(shape).to_have_value("ball")
    assert violations(toy) == []

    revision = revision_of(toy)
    shape.focus()
    toy.keyboard.press("g")
    expect(shape).to_have_value("gone")
    revision = wait_edited(toy, revision)
    without_ball = shown_picture(toy)
    assert without_ball.mean() < 0.9 * whole.mean()
    tram = dialog.get_by_role("checkbox", name="/World/tram")
    tram.press("Space")
    expect(tram).not_to_be_checked()
    revision = wait_edited(toy, revision)
    assert shown_picture(toy).max() < 0.5 * without_ball.max()
    assert violations(toy) == []

    dialog.get_by_role("button", name="As in the shot: shape of /World/toy").press("Enter")
    expect(shape).to_have_value("ball")
    revision = wait_edited(toy, revision)
    toy.keyboard.press("Escape")
    expect(dialog).to_be_hidden()
    for _ in range(3):
        toy.keyboard.press("Control+z")
        revision = wait_edited(toy, revision)
    assert np.abs(shown_picture(toy) - whole).max() < 0.01
