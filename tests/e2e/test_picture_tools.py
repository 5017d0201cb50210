"""Tools on the picture: zoom, loupe and full screen; comparison with another picture; exposure."""

from __future__ import annotations

import base64
import io
import re
from pathlib import Path

import httpx
import numpy as np
import OpenImageIO
import pytest
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Locator, Page, expect

from tests.e2e.editor import NEAR, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]


def middle(place: Locator) -> tuple[float, float]:
    """Return the middle of an element in the window, px."""
    box = place.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def test_zoom_keeps_the_place_under_the_pointer(page: Page, pixel_ratio: float) -> None:
    wait_settled(page, time=1)
    page.evaluate("localStorage.setItem('pullfocus.delivery', '1280')")
    page.reload()
    wait_settled(page, time=1)
    marker = page.locator(".marker", has_text=NEAR)
    at = middle(marker)
    page.mouse.move(*at)
    page.keyboard.press("z")
    picture = page.locator(".picture")
    expect(page.locator(".surround")).to_have_attribute("data-scale", "1")
    box = picture.bounding_box()
    assert box is not None
    assert box["width"] * pixel_ratio == 1280  # a device pixel for each pixel of the delivered picture
    assert middle(marker) == pytest.approx(at, abs=2 / pixel_ratio)
    page.mouse.move(at[0] + 20, at[1] + 60)  # beside the marker
    page.keyboard.down(" ")
    page.mouse.down()
    page.mouse.move(at[0] + 50, at[1] + 80)
    page.mouse.up()
    page.keyboard.up(" ")
    assert middle(marker) == pytest.approx((at[0] + 30, at[1] + 20), abs=2 / pixel_ratio)
    expect(page.get_by_role("button", name="Play", exact=True)).to_be_visible()  # the drag has played nothing
    page.keyboard.down("n")
    expect(page.get_by_role("img", name="Loupe")).to_be_visible()
    page.wait_for_function("since => performance.now() - since > 400", arg=page.evaluate("performance.now()"))
    page.keyboard.up("n")  # which was held down
    expect(page.get_by_role("img", name="Loupe")).to_have_count(0)
    page.keyboard.press("z")
    assert middle(marker) == pytest.approx(at, abs=2 / pixel_ratio)


def test_the_picture_fills_the_screen(page: Page) -> None:
    wait_settled(page, time=1)
    page.keyboard.press("Alt+f")
    page.wait_for_function("() => document.fullscreenElement?.classList.contains('viewer') === true")
    page.keyboard.press("Alt+f")
    page.wait_for_function("() => document.fullscreenElement === null")


def pixels(canvas: Locator) -> NDArray[np.int64]:
    """Return ``(height, width, 3)`` the display values, 0 to 255, of a canvas."""
    address = canvas.evaluate("canvas => canvas.toDataURL('image/png')")
    picture = Image.open(io.BytesIO(base64.b64decode(address.split(",")[1]))).convert("RGB")
    return np.asarray(picture).astype(np.int64)


def test_a_snapshot_is_compared_by_keys(page: Page) -> None:
    canvas = wait_settled(page, time=1)
    before = pixels(canvas)
    page.keyboard.press("h")
    page.keyboard.press("End")
    wait_settled(page, time=96)
    page.keyboard.press("a")
    other = page.locator("canvas.compared[data-mode=other]")
    expect(other).to_have_js_property("width", before.shape[1])  # it is painted a frame after it is there
    expect(other).to_have_js_property("height", before.shape[0])
    np.testing.assert_array_equal(pixels(other), before)
    expect(page.locator(".compare-said")).to_contain_text("B: frame 1, main_cam, ")
    page.keyboard.press("a")
    expect(other).to_have_count(0)


def test_false_colour_and_zebra_are_at_stated_stops(page: Page, service: str, tmp_path: Path) -> None:
    canvas = wait_settled(page, time=1)
    page.keyboard.press("y")
    painted = page.locator("canvas.exposure[data-painted=falseColour]")
    painted.wait_for()
    colours = pixels(painted)
    legend = page.locator(".of-exposure b")
    bands = {
        float(band.inner_text().replace("\u2212", "-")): re.findall(r"\d+", band.evaluate("b => b.style.background"))
        for band in legend.all()
    }
    height, width, _ = colours.shape
    size = {"time": 1, "width": width, "height": height}
    light = httpx.get(f"{service}/v1/shots/demo/frame", params=size | {"format": "exr"}, timeout=300).raise_for_status()
    (tmp_path / "light.exr").write_bytes(light.content)
    radiance = OpenImageIO.ImageBuf(str(tmp_path / "light.exr")).get_pixels(OpenImageIO.FLOAT)[..., :3]
    luminance = radiance @ np.array([0.2722287, 0.6740818, 0.0536895])
    exposure = httpx.get(f"{service}/v1/shots/demo/readout/exposure", params={"time": 1}, timeout=120).json()
    stops = np.log2(np.maximum(exposure["exposureScale"] * luminance / 0.18, 1e-9))
    nearest = np.clip(np.rint(stops), min(bands), max(bands))
    expected = np.array([[int(one) for one in bands[stop]] for stop in sorted(bands)])[
        (nearest - min(bands)).astype(int)
    ]
    is_clear = np.abs(stops - np.floor(stops) - 0.5) > 0.01  # of the edge of a colour
    np.testing.assert_array_equal(colours[is_clear], expected[is_clear])
    assert len(np.unique(nearest)) > 6
    page.keyboard.press("Shift+y")
    striped = page.locator("canvas.exposure[data-painted=zebra]")
    striped.wait_for()
    expect(page.locator(".of-exposure")).to_contain_text("2.5 stops above grey")
    covered = pixels(striped).max(axis=2) > 0
    scale = canvas.evaluate("canvas => [canvas.width, canvas.height]")
    assert covered.shape == (scale[1], scale[0])
    assert covered.mean() == pytest.approx((stops >= 2.5).mean() / 2, abs=0.01)


def test_two_lenses_by_a_wipe_and_by_difference(page: Page, service: str) -> None:
    canvas = wait_settled(page, time=1)
    present = pixels(canvas)
    page.get_by_role("button", name="Tools on the picture").click()
    page.locator("#tools .choice:has(> span:text-is('Lens')) select").select_option("lens biotar_58")
    page.get_by_role("radio", name="Wipe").click()
    other = page.locator("canvas.compared[data-best=true]")
    other.wait_for()
    biotar = pixels(other)
    divider = page.get_by_role("slider", name=re.compile("^Divider"))
    divider.focus()
    page.keyboard.press("Shift+ArrowRight")
    expect(divider).to_have_attribute("aria-valuenow", "60")
    assert "60%" in other.evaluate("canvas => canvas.style.clipPath")  # the present picture is on the left of it
    page.get_by_role("radio", name="Difference").click()
    for gain in (1, 16):
        page.get_by_role("radio", name=f"{gain} ×", exact=True).click()
        page.locator("canvas.compared[data-mode=difference]").wait_for()
        difference = np.minimum(gain * np.abs(present - biotar), 255)
        np.testing.assert_array_equal(pixels(other), difference)
    assert (difference > 0).mean() > 0.3
    # The other picture is the one that the shot has once that lens is mounted.
    page.get_by_role("radio", name="Off").click()
    camera = f"{service}/v1/shots/demo/camera"
    httpx.patch(camera, json={"lens": "biotar_58"}, timeout=120).raise_for_status()
    page.reload()
    np.testing.assert_array_equal(pixels(wait_settled(page, time=1)), biotar)
