"""The set from above in a real browser: its drawing is the readouts to a pixel, and points and the focus are moved in it."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import httpx
import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Locator, Page, expect

from tests.e2e.axe import violations
from tests.e2e.editor import FAR, NEAR, focus_points, tab_to

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

FRAME = 40
DEMO = "/v1/shots/demo"


@pytest.fixture
def opened(page: Page) -> Page:
    """The page with the set from above, opened by its key."""
    page.set_viewport_size({"width": 1300, "height": 760})
    page.goto(f"/?shot=demo&time={FRAME}")
    page.get_by_role("button", name="Top view", exact=True).wait_for()
    page.keyboard.press("v")
    wait_fitted(page)
    return page


def wait_fitted(page: Page) -> None:
    """Wait until the drawing shows all: it is fitted anew when the ways of the points are there."""
    marker(page, FAR).wait_for()
    page.locator('[data-way="mara"][d^="M"]').wait_for(state="attached")


def marker(page: Page, name: str) -> Locator:
    return page.locator(f".plan-marker[data-point={name}]")


def handle(page: Page) -> Locator:
    return page.get_by_role("slider", name="Focus distance from above")


def read(service: str, path: str, **query: Any) -> Any:
    return httpx.get(f"{service}{DEMO}/{path}", params={"time": FRAME} | query, timeout=120).raise_for_status().json()


def sheet_of(page: Page) -> tuple[float, NDArray[np.float64]]:
    """Return the scale of the drawing, px for each metre, and the camera in it, px."""
    scale, x, y = page.locator(".plan-lines").evaluate(
        "svg => [svg.dataset.pxPerM, svg.dataset.cameraX, svg.dataset.cameraY]"
    )
    return float(scale), np.array([float(x), float(y)])


def places_of(page: Page, selector: str) -> NDArray[np.float64]:
    """Return the ends of a drawn line in the plan, metres to the right and ahead."""
    scale, camera = sheet_of(page)
    drawn = page.locator(f".plan-lines {selector}").get_attribute("d") or ""
    spots = np.array([pair.split() for pair in re.findall(r"[ML]([-\d.]+ [-\d.]+)", drawn)], np.float64)
    return (spots - camera) / scale * (1, -1)


def depth_at(places: NDArray[np.float64], slope: float) -> float:
    """Depth at which a line across the picture meets a ray from the camera."""
    across = places[:, 0] - slope * places[:, 1]
    order = np.argsort(across)
    return float(np.interp(0, across[order], places[order, 1]))


def edit(page: Page, service: str, label: str, act: Callable[[], None]) -> None:
    """Do what is one edit, and wait until it is made."""
    act()
    page.get_by_role("button", name=f"Undo: {label}").wait_for()


def undo(page: Page) -> None:
    page.keyboard.press("Control+z")
    page.get_by_role("button", name=re.compile("^Redo: ")).wait_for()


def drag(page: Page, what: Locator, right: float, down: float) -> None:
    box = what.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    for share in (0.3, 0.7, 1.0):
        page.mouse.move(x + share * right, y + share * down)
    page.mouse.up()


def test_the_drawing_is_the_readouts_to_a_pixel(page: Page, service: str, opened: Page) -> None:
    swing = {"mode": "manual", "swingDeg": 0.4}
    httpx.patch(f"{service}{DEMO}/camera/focus", json=swing, timeout=120).raise_for_status()
    httpx.patch(f"{service}{DEMO}/camera", json={"fStop": 4, "focusDistanceM": 4}, timeout=120).raise_for_status()
    page.reload()
    lens, points = read(service, "readout"), focus_points(service, FRAME)
    expect(page.locator(".plan-foot")).to_contain_text("f/4")
    wait_fitted(page)
    scale, camera = sheet_of(page)
    pixel = 1 / scale
    for line, name in (("nearW", "nearM"), ("focusW", "focusDistanceM"), ("farW", "farM")):
        assert depth_at(places_of(page, f".plan-cut.{line}"), 0) == pytest.approx(lens[name], abs=pixel), name
    view = read(service, "top-view")
    for x, slope in ((0, view["edges"][0]), (1, view["edges"][1])):  # the plane is swung: other depths at both edges
        at = read(service, "readout/place", x=x, y=0.5, depthM=4)
        assert abs(at["focusDistanceM"] - lens["focusDistanceM"]) > 5 * pixel
        for line, name in (("nearW", "nearM"), ("focusW", "focusDistanceM"), ("farW", "farM")):
            assert depth_at(places_of(page, f".plan-cut.{line}"), slope) == pytest.approx(at[name], abs=pixel), name
    wedge = places_of(page, ".plan-wedge")
    assert wedge[:, 1].min() == pytest.approx(
        min(read(service, "readout/place", x=x, y=0.5, depthM=4)["nearM"] for x in (0, 1)), abs=pixel
    )
    for name in (NEAR, FAR):
        off = places_of(page, f'[data-residual="{name}"]')
        assert off[0, 1] == pytest.approx(points[name]["depthM"], abs=pixel)
        residual = points[name]["depthM"] - points[name]["focusDistanceM"]
        assert off[0, 1] - off[1, 1] == pytest.approx(residual, abs=pixel)
        spot = marker(page, name).evaluate("at => [parseFloat(at.style.left), parseFloat(at.style.top)]")
        assert camera[1] - spot[1] == pytest.approx(points[name]["depthM"] * scale, abs=1)
    way = np.array(points[FAR]["positionM"]) - view["positionM"]
    assert spot[0] - camera[0] == pytest.approx(way @ view["right"] * scale, abs=1)


def test_a_point_and_the_focus_are_dragged(page: Page, service: str, opened: Page) -> None:
    view, before = read(service, "top-view"), focus_points(service, FRAME)[FAR]
    scale, _ = sheet_of(page)
    edit(page, service, f"Move {FAR}", lambda: drag(page, marker(page, FAR), -20, 40))
    moved = focus_points(service, FRAME)[FAR]
    way = (np.array(moved["positionM"]) - before["positionM"]) * scale
    up = np.cross(view["right"], view["ahead"])
    assert (way @ view["right"], way @ view["ahead"], way @ up) == pytest.approx((-20, -40, 0), abs=1)
    assert (moved["target"], moved["depthM"]) == (
        before["target"],
        pytest.approx(before["depthM"] - 40 / scale, abs=1 / scale),
    )
    undo(page)
    assert focus_points(service, FRAME)[FAR]["positionM"] == pytest.approx(before["positionM"], abs=1e-6)

    if read(service, "readout")["focusMode"] != "manual":
        expect(handle(page)).to_have_attribute("aria-disabled", "true")
        edit(page, service, "Focus by hand", lambda: page.get_by_role("radio", name="By hand").click())
    expect(handle(page)).to_have_attribute("aria-disabled", "false")
    own = read(service, "readout")["focusDistanceM"]
    edit(page, service, "focus distance", lambda: drag(page, handle(page), 0, -50))
    assert read(service, "readout")["focusDistanceM"] == pytest.approx(own + 50 / scale, abs=1 / scale)


def test_the_keyboard_alone_moves_all(page: Page, service: str, opened: Page) -> None:
    assert violations(page) == []
    before = focus_points(service, FRAME)[FAR]
    plan = page.get_by_role("group", name=re.compile("^Plan: "))
    tab_to(page, plan)
    page.locator("[data-reading=near]").wait_for(state="attached")  # it may come after the plan was fitted
    page.keyboard.press("f")
    scale, _ = sheet_of(page)
    page.keyboard.press("+")
    page.keyboard.press("ArrowRight")
    assert sheet_of(page)[0] == pytest.approx(1.25 * scale)
    page.keyboard.press("f")
    assert sheet_of(page)[0] == pytest.approx(scale)
    tab_to(page, marker(page, FAR))
    edit(page, service, f"Move {FAR}", lambda: page.keyboard.press("ArrowDown"))
    step = before["depthM"] - focus_points(service, FRAME)[FAR]["depthM"]
    grid = float((page.locator("[data-plan=grid]").inner_text()).removesuffix(" m"))
    assert step == pytest.approx(grid / 10, abs=1e-4)
    undo(page)
    page.keyboard.press("Shift+V")
    expect(page.get_by_role("radio", name="North")).to_have_attribute("aria-checked", "true")
    assert violations(page) == []
    page.keyboard.press("Shift+V")
    page.keyboard.press("v")
    expect(page.locator(".top-view")).to_have_count(0)
