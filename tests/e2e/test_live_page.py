"""Live pictures in a real browser: seen while a hand moves, exact when it rests, and there without a WebSocket too."""

from __future__ import annotations

import io
import re
from contextlib import suppress
from typing import Any

import httpx
import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser, Error, Page, Route, expect

from tests.e2e.conftest import PATIENCE_MS, VIEWPORT
from tests.e2e.editor import FAR, NEAR, focus_points, metres, readout_m, revision_of, shown_picture, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

WATCH = """() => {
    const canvas = document.querySelector("canvas");
    window.seen = [];
    const note = () => window.seen.push({ ...canvas.dataset, data: canvas.toDataURL("image/jpeg", 0.5).length });
    new MutationObserver(note).observe(canvas, { attributes: true, attributeFilter: ["width"] });
}"""
NO_SOCKET = """window.WebSocket = class {
    constructor() { setTimeout(() => this.onclose?.(new CloseEvent("close"))); }
    send() {}
    close() {}
};"""


def history(service: str) -> dict[str, Any]:
    """The states of the demo shot's edits."""
    told: dict[str, Any] = httpx.get(f"{service}/v1/shots/demo/edits/history", timeout=120).raise_for_status().json()
    return told


def untouched(service: str) -> None:
    """Make the demo shot what it was before anybody edited it."""
    first = history(service)["steps"][0]["revision"]
    httpx.put(f"{service}/v1/shots/demo/edits", json={"revision": first}, timeout=120).raise_for_status()


def wait_for_pictures(page: Page, count: int) -> None:
    """Wait until so many pictures of what is tried were on screen since `WATCH`."""
    page.wait_for_function("n => window.seen.filter(shown => shown.unsaved === 'true').length >= n", arg=count)


def test_a_drag_of_the_focus_is_live_and_exact_at_its_end(page: Page, service: str) -> None:
    untouched(service)
    page.goto("/?shot=demo&time=40")
    wait_settled(page, time=40)
    before, near = history(service), readout_m(page, "near")
    slider = page.get_by_role("slider", name="Focus distance").bounding_box()
    assert slider is not None
    y = slider["y"] + slider["height"] / 2
    page.evaluate(WATCH)
    page.mouse.move(slider["x"] + 0.42 * slider["width"], y)
    page.mouse.down()
    for step in range(1, 4):
        page.mouse.move(slider["x"] + (0.42 + 0.04 * step) * slider["width"], y)
        wait_for_pictures(page, step)
    expect(page.locator("canvas")).to_have_attribute("data-stage", "preview")
    seen = [shown for shown in page.evaluate("window.seen") if shown["unsaved"] == "true"]
    assert len({shown["data"] for shown in seen}) > 1  # they are other pictures
    page.wait_for_function("near => document.querySelector('[data-reading=near]').innerText !== near", arg=f"{near} m")
    assert history(service) == before  # nothing is saved yet

    revision = revision_of(page)
    page.mouse.up()
    page.wait_for_function(
        "old => Number(document.querySelector('canvas[data-settled=true]')?.dataset.revision ?? -1) > old", arg=revision
    )
    shown = shown_picture(page)
    height, width = shown.shape
    asked = {"time": 40, "width": width, "height": height, "rays": 100, "layers": 4, "supersample": 0}
    file = httpx.get(f"{service}/v1/shots/demo/frame", params=asked | {"motionBy": "velocities"}, timeout=300)
    exact = np.asarray(Image.open(io.BytesIO(file.content)).convert("RGB"), np.float64) @ (0.2126, 0.7152, 0.0722) / 255
    assert np.array_equal(shown, exact)
    distance = metres(page.get_by_role("textbox", name="Focus distance").input_value())
    told = httpx.get(f"{service}/v1/shots/demo/readout", params={"time": 40}, timeout=120).json()
    assert told["focusDistanceM"] == pytest.approx(distance, rel=0.01)
    assert history(service)["now"] == before["now"] + 1
    page.get_by_role("button", name="Undo: focus distance").click()
    expect(page.get_by_role("button", name="Redo: focus distance")).to_be_enabled()
    assert history(service)["revision"] == before["revision"]


def test_a_given_up_drag_shows_again_what_was_there(page: Page, service: str) -> None:
    untouched(service)
    page.goto("/?shot=demo&time=40")
    wait_settled(page, time=40)
    before, shown = history(service)["revision"], shown_picture(page)
    slider = page.get_by_role("slider", name="f-number")
    box = slider.bounding_box()
    assert box is not None
    page.evaluate(WATCH)
    page.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.7 * box["width"], box["y"] + box["height"] / 2)
    wait_for_pictures(page, 1)
    page.keyboard.press("Escape")
    page.mouse.up()
    page.wait_for_selector("canvas[data-settled=true]")
    assert np.array_equal(shown_picture(page), shown)
    assert history(service)["revision"] == before


def test_a_marker_that_is_dragged_takes_the_focus_with_it(page: Page, service: str) -> None:
    untouched(service)
    page.goto("/?shot=demo&time=40")
    wait_settled(page, time=40)
    placed = focus_points(service, 40)
    canvas = page.locator("canvas").bounding_box()
    assert canvas is not None
    start, end = (
        (canvas["x"] + x * canvas["width"], canvas["y"] + y * canvas["height"])
        for x, y in (placed[NEAR]["screen"], placed[FAR]["screen"])
    )
    page.evaluate(WATCH)
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    page.mouse.move(end[0], end[1] + 12)  # beside the other marker, on the same robot
    far_m = placed[FAR]["depthM"]
    said = page.get_by_role("textbox", name="Focus distance")
    expect(said).to_have_value(re.compile(rf"^{int(far_m)}\."))
    assert focus_points(service, 40)[NEAR]["depthM"] == pytest.approx(placed[NEAR]["depthM"])  # it is tried, not done
    wait_for_pictures(page, 1)
    page.mouse.up()
    page.wait_for_selector("canvas[data-settled=true][data-unsaved=false]")
    assert focus_points(service, 40)[NEAR]["depthM"] == pytest.approx(far_m, rel=0.1)
    untouched(service)


def test_without_a_websocket_pictures_come_one_by_one(browser: Browser, service: str, pixel_ratio: float) -> None:
    page = browser.new_page(base_url=service, viewport=VIEWPORT, device_scale_factor=pixel_ratio)
    page.set_default_timeout(PATIENCE_MS)
    page.add_init_script(NO_SOCKET)
    page.goto("/?shot=demo&time=1")
    wait_settled(page, time=1)
    page.keyboard.press("ArrowRight")
    wait_settled(page, time=2)
    expect(page.get_by_role("alert")).to_have_count(0)
    page.close()


def test_a_picture_that_is_not_the_wanted_one_says_so(browser: Browser, service: str, pixel_ratio: float) -> None:
    page = browser.new_page(base_url=service, viewport=VIEWPORT, device_scale_factor=pixel_ratio)
    page.set_default_timeout(PATIENCE_MS)
    page.add_init_script(NO_SOCKET)
    page.goto("/?shot=demo&time=1")
    wait_settled(page, time=1)
    held: list[Route] = []
    page.route("**/frame?*", lambda route: held.append(route))

    page.keyboard.press("End")

    expect(page.locator(".wanted")).to_have_text("Frame 1, wanted 96")
    expect(page.locator("canvas.late")).to_have_css("filter", "brightness(0.6)")
    page.unroute("**/frame?*")
    for route in held:
        with suppress(Error):  # one that was cancelled, or went on by itself
            route.continue_()
    wait_settled(page, time=96)
    expect(page.locator(".wanted")).to_have_count(0)
    expect(page.locator("canvas.late")).to_have_count(0)
    page.close()
