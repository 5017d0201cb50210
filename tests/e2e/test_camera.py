"""The camera in a real browser: exposure and its meter, film and its sheet, body and framing, keys, curves of other tools."""

from __future__ import annotations

from pathlib import Path

import httpx
import numpy as np
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.editor import choose_file, revision_of, shown_picture, wait_edited, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]


@pytest.fixture
def camera(page: Page) -> Page:
    """The editor with the camera's panel open."""
    wait_settled(page, time=1)
    page.keyboard.press("c")
    expect(page.get_by_role("tab", name="Camera & film")).to_have_attribute("aria-selected", "true")
    return page


def off_by(page: Page) -> float:
    """Return the light meter's reading, in stops."""
    reading = page.locator("[data-meter='off by']")
    expect(reading).not_to_have_text("–")
    return float(reading.inner_text().replace("−", "-").replace("±", ""))


def test_a_stop_more_of_iso_is_a_stop_more_on_the_meter_and_brighter(camera: Page) -> None:
    before, dark = off_by(camera), shown_picture(camera)
    revision = revision_of(camera)
    iso = camera.get_by_role("textbox", name="ISO")
    iso.fill("200")
    iso.press("Enter")
    revision = wait_edited(camera, revision)
    expect(camera.locator("[data-meter='off by']")).to_have_text(
        f"{before + 1:+.1f}".replace(".0", "").replace("-", "−")
    )
    assert shown_picture(camera).mean() > 1.15 * dark.mean()

    camera.get_by_role("button", name="Set to meter").click()
    revision = wait_edited(camera, revision)
    expect(camera.locator("[data-meter='off by']")).to_have_text("±0")
    camera.get_by_role("button", name="Undo: Set to the meter").click()
    revision = wait_edited(camera, revision)
    camera.keyboard.press("Control+z")
    wait_edited(camera, revision)
    expect(iso).to_have_value("100")
    assert np.abs(shown_picture(camera) - dark).max() < 0.01


def test_the_shutter_exposes_by_its_time_once_they_match(camera: Page, service: str) -> None:
    before, revision = shown_picture(camera), revision_of(camera)
    camera.get_by_role("button", name="Match").click()
    revision = wait_edited(camera, revision)
    assert np.abs(shown_picture(camera) - before).max() < 0.02
    shutter = camera.get_by_role("textbox", name="Shutter")
    shutter.fill("1/96")
    shutter.press("Enter")
    wait_edited(camera, revision)
    expect(shutter).to_have_value("90°")
    asked = httpx.get(f"{service}/v1/shots/demo/camera/exposure", params={"time": 1}, timeout=120).json()
    assert asked["exposureTimeS"] == pytest.approx(1 / 96, rel=1e-5)
    assert shown_picture(camera).mean() < before.mean()


def test_a_film_is_loaded_has_a_sheet_and_is_taken_out_again(camera: Page) -> None:
    revision = revision_of(camera)
    stock = camera.get_by_label("Stock")
    stock.select_option("double_x_5222")
    revision = wait_edited(camera, revision)
    expect(camera.get_by_role("textbox", name="Grain")).to_have_value("1×")
    camera.get_by_role("button", name="Sheet").click()
    sheet = camera.get_by_role("img", name="Sheet of Kodak Double-X 5222")
    expect(sheet).to_be_visible()
    assert sheet.evaluate("picture => picture.naturalWidth") > 800
    camera.keyboard.press("Escape")
    expect(sheet).to_have_count(0)

    camera.get_by_role("button", name="Key of Push", exact=True).click()
    revision = wait_edited(camera, revision)
    expect(camera.get_by_role("button", name="Key of Push", exact=True)).to_have_attribute("aria-pressed", "true")
    stock.select_option("")
    wait_edited(camera, revision)
    expect(camera.get_by_role("textbox", name="Grain")).to_have_count(0)


def test_a_body_gives_the_picture_its_shape(camera: Page) -> None:
    revision = revision_of(camera)
    camera.locator(".body").get_by_label("Body").last.select_option("academy_35")
    revision = wait_edited(camera, revision)
    box = camera.locator("canvas").bounding_box()
    assert box is not None
    assert box["width"] / box["height"] == pytest.approx(22.05 / 16.03, rel=0.02)
    camera.keyboard.press("Control+z")
    wait_edited(camera, revision)


def test_a_curve_of_another_tool_is_imported(page: Page, tmp_path: Path) -> None:
    wait_settled(page, time=1)
    file = tmp_path / "pulled.csv"
    file.write_text("frame,focus_distance_m\n" + "".join(f"{frame},{2 + frame / 32}\n" for frame in range(1, 97)))
    revision = revision_of(page)
    choose_file(page, file, "Import…")
    revision = wait_edited(page, revision)
    expect(page.get_by_role("radio", name="By hand")).to_be_checked()
    expect(page.get_by_role("textbox", name="Focus distance")).to_have_value("2.03 m")
    page.get_by_role("button", name="Undo: Import pulled.csv").click()
    wait_edited(page, revision)
    expect(page.get_by_role("radio", name="Points", exact=True)).to_be_checked()
