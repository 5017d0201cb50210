"""Sharpness on the picture: peaking, false colour, lines, the probe, and the words on the points."""

from __future__ import annotations

import base64
import io
import re

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Page, expect

from render.demo.shot import write_demo
from render.frame import FrameRenderer, FrameSettings
from render.model.arrays import FloatArray
from render.shot import Shot
from tests.e2e.editor import FAR, NEAR, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

FRAME = 40
LIMIT_MM = 0.0275363
"""Largest circle of confusion of the demo's gate that is sharp: its diagonal over 1500."""


@pytest.fixture(scope="module")
def shot(tmp_path_factory: pytest.TempPathFactory) -> Shot:
    folder = tmp_path_factory.mktemp("demo")
    write_demo(folder)
    return Shot.open(folder / "night_street.usda")


def measure(shot: Shot, width: int, height: int) -> tuple[FloatArray, FloatArray]:
    """Measure circles of confusion, as diameters on the film in mm, and depths by the AOVs of the frame."""
    camera = shot.camera_at(None, FRAME, width, height)
    settings = FrameSettings(width, height, rays=1, layers=1, aovs=("color", "coc", "depth"))
    with FrameRenderer() as renderer:
        aovs = renderer.render(shot.scene_at(FRAME, camera.path), camera, settings).aovs
    return 2 * aovs["coc"] * camera.horizontal_aperture_mm / width, aovs["depth"]


def overlay(page: Page) -> NDArray[np.uint8]:
    """Return ``(height, width, 4)`` what is drawn over the exact picture."""
    canvas = page.locator("canvas.sharpness[data-painted=final]")
    address = canvas.evaluate("canvas => canvas.toDataURL('image/png')")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(address.split(",")[1]))).convert("RGBA"))


def test_peaking_and_probe_have_the_numbers_of_the_aov(page: Page, shot: Shot) -> None:
    page.goto(f"/?shot=demo&time={FRAME}")
    wait_settled(page, time=FRAME)
    page.keyboard.press("p")
    peaking = overlay(page)[..., 3] > 0
    height, width = peaking.shape
    coc_mm, depth_m = measure(shot, width, height)
    is_clear = np.abs(np.abs(coc_mm) - LIMIT_MM) > 1e-5  # of the limit, which this test knows to six digits
    np.testing.assert_array_equal(peaking[is_clear], (np.abs(coc_mm) <= LIMIT_MM)[is_clear])
    assert 0.02 < peaking.mean() < 0.5
    box = page.locator(".picture").bounding_box()
    assert box is not None
    for row, column in ((height // 2, width // 3), (height // 3, 3 * width // 4), (height // 8, width // 2)):
        page.mouse.move(
            box["x"] + (column + 0.5) / width * box["width"], box["y"] + (row + 0.5) / height * box["height"]
        )
        probe = page.locator(".probe")
        expect(probe).to_have_attribute("data-coc-mm", re.compile(r"\d"))
        assert float(probe.get_attribute("data-coc-mm") or "nan") == pytest.approx(coc_mm[row, column], rel=1e-5)
        assert float(probe.get_attribute("data-depth-m") or "nan") == pytest.approx(depth_m[row, column], rel=1e-6)
        expect(probe).to_contain_text("in focus" if abs(coc_mm[row, column]) <= LIMIT_MM else "sharp at f/")


def test_false_colour_and_lines_are_chosen_by_mouse(page: Page) -> None:
    page.goto(f"/?shot=demo&time={FRAME}")
    wait_settled(page, time=FRAME)
    page.get_by_role("button", name=re.compile("Sharpness on the picture")).click()
    page.get_by_role("radio", name="False colour").click()
    colours = overlay(page)
    assert (colours[..., 3] == 255).all()
    red, green, blue = np.moveaxis(colours[..., :3].astype(int), -1, 0)
    for seen in (green > np.maximum(red, blue) + 20, blue > red + 20, red > blue + 20):  # sharp, behind, in front
        assert 0.01 < seen.mean() < 0.9
    expect(page.locator(".focus-legend")).to_contain_text("0.028 mm, 1.5 px of 1920")
    page.get_by_label("Delivered at").select_option("3840")
    expect(page.locator(".focus-legend")).to_contain_text("2.9 px of 3840")
    page.get_by_role("radio", name="Nothing").click()
    page.get_by_label("Lines of focus and its limits").check()
    drawn = overlay(page)[..., 3] > 0
    assert 0.001 < drawn.mean() < 0.1
    before = page.locator("canvas.sharpness").evaluate(
        """canvas => {
            const before = canvas.toDataURL();
            canvas.dataset.lost = "yes";
            canvas.getContext("webgl2").getExtension("WEBGL_lose_context").loseContext();
            return before;
        }"""
    )
    page.wait_for_function(
        """before => {
            const canvas = document.querySelector("canvas.sharpness");
            return canvas.dataset.lost === undefined && canvas.toDataURL() === before;
        }""",
        arg=before,
    )
    page.get_by_label("Lines of focus and its limits").uncheck()
    expect(page.locator("canvas.sharpness")).to_have_count(0)


def test_each_point_is_said_to_be_sharp_or_soft(page: Page) -> None:
    wait_settled(page, time=1)
    expect(page.get_by_role("button", name=re.compile(f"Focus point {NEAR} .* sharp"))).to_be_visible()
    expect(page.get_by_role("button", name=re.compile(rf"Focus point {FAR} .* soft, \+6\.\d\d m"))).to_be_visible()
    far = page.locator(".point", has_text=FAR).locator(".verdict")
    expect(far).to_have_text(re.compile(r"^soft \+6\.\d\d m 0\.\d\d mm, \d\d px$"))
    page.get_by_role("radio", name="ft", exact=True).click()
    expect(far).to_have_text(re.compile(r"^soft \+2\d′ \d+″ "))
