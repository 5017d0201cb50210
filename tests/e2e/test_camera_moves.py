"""The camera moved in a real browser: by the mouse and by the keyboard alone; keyed, framed on a subject and duplicated."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import httpx
import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Page, expect

from tests.e2e.axe import violations
from tests.e2e.editor import FAR, focus_points, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

DEMO = "/v1/shots/demo"
DOLLY = 2 ** (-0.05 / 0.5)
"""Factor of the distance by one press of PageUp."""


def read(service: str, path: str, **query: Any) -> Any:
    return httpx.get(f"{service}{DEMO}/{path}", params=query, timeout=120).raise_for_status().json()


def way(service: str) -> NDArray[np.float64]:
    return np.array(read(service, "paths")["cameraM"])


def pose(service: str, time: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    view = read(service, "top-view", time=time)
    return np.array(view["positionM"]), np.array(view["ahead"])


def depth(service: str, time: float) -> float:
    """Depth of the pivot, which is the focus where no point is selected."""
    view = read(service, "top-view", time=time)
    return 1 / view["axis"]["focusW"] - view["setBackM"]


def wait_undo(page: Page, label: str) -> None:
    page.get_by_role("button", name=f"Undo: {label}").wait_for()


@pytest.fixture(autouse=True)
def as_before(service: str) -> Iterator[None]:
    """Undo what a test has edited."""
    yield
    while read(service, "edits/history")["undo"] is not None:
        httpx.post(f"{service}{DEMO}/edits/undo", timeout=120).raise_for_status()


def test_the_mouse_orbits_about_the_focus_and_undo_takes_it_back(page: Page, service: str) -> None:
    wait_settled(page, time=1)
    (before, ahead), far, steps = pose(service, 1), depth(service, 1), read(service, "edits/history")["now"]
    pivot = before + far * ahead
    box = page.locator(".picture").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.keyboard.down("Alt")
    page.mouse.move(x, y)
    page.mouse.down()
    for share in (0.1, 0.6, 1.0):
        page.mouse.move(x + share * box["width"] / 6, y)
    page.locator("canvas[data-unsaved=true]").wait_for()
    page.mouse.up()
    page.keyboard.up("Alt")
    wait_undo(page, "Move the camera")
    after, turned = pose(service, 1)
    assert after + far * turned == pytest.approx(pivot, abs=1e-5)
    across = [np.arctan2(vector[0], vector[2]) for vector in (ahead, turned)]
    assert np.angle(np.exp(1j * (across[1] - across[0]))) == pytest.approx(-np.pi / 6, abs=0.01)
    assert turned[1] == pytest.approx(ahead[1], abs=1e-9)
    assert read(service, "edits/history")["now"] == steps + 1
    page.keyboard.press("Control+z")
    page.get_by_role("button", name=re.compile("^Redo: ")).wait_for()
    assert pose(service, 1)[0] == pytest.approx(before)


def test_the_keyboard_alone_dollies_and_keys_two_frames(page: Page, service: str) -> None:
    wait_settled(page, time=1)
    ways = way(service)
    aims = {time: (*pose(service, time), depth(service, time)) for time in (1, 96)}
    page.keyboard.press("Shift+E")
    bar = page.get_by_role("group", name="Move the camera")
    page.keyboard.press("Shift+A")
    expect(bar.get_by_role("button", name="Key")).to_have_attribute("aria-pressed", "true")
    assert violations(page) == []
    for key, time in (("Home", 1), ("End", 96)):
        page.keyboard.press(key)
        wait_settled(page, time=time)
        edits = read(service, "edits/history")["now"]
        page.keyboard.press("PageUp")
        page.wait_for_function(
            """async (known) => (await (await fetch("/v1/shots/demo/edits/history")).json()).now > known""", arg=edits
        )
        wait_settled(page, time=time)
    for time, (position, ahead, far) in aims.items():
        moved, now = pose(service, time)
        assert now == pytest.approx(ahead, abs=1e-7)
        assert moved - position == pytest.approx(far * (1 - DOLLY) * ahead, rel=1e-3, abs=1e-5)
    assert way(service)[1:-1] == pytest.approx(ways[1:-1], abs=1e-6)
    page.keyboard.press("Shift+E")
    expect(bar).to_be_hidden()


def test_a_duplicate_is_looked_through(page: Page, service: str) -> None:
    wait_settled(page, time=1)
    (own,) = httpx.get(f"{service}{DEMO}", timeout=120).json()["cameras"]
    page.keyboard.press("Shift+D")
    page.wait_for_url(re.compile(re.escape(f"{own}_2").replace("/", "(/|%2F)")))
    wait_settled(page, time=1)
    assert httpx.get(f"{service}{DEMO}", timeout=120).json()["cameras"] == [own, f"{own}_2"]
    # The copy takes a lens and a body of its own.
    page.get_by_role("combobox", name="Lens on the camera").click()
    page.keyboard.type("glass tele")
    expect(page.get_by_role("option", name="Telephoto 250 mm f/5.6")).to_have_attribute("aria-selected", "true")
    page.keyboard.press("Enter")
    wait_undo(page, "Mount Telephoto 250 mm f/5.6")
    page.get_by_role("tab", name="Camera & film").click()
    page.locator(".body").get_by_label("Body").last.select_option("academy_35")
    page.get_by_role("button", name=re.compile("^Undo: Mount the ")).wait_for()
    before, copy = (read(service, "camera", time=1, camera=path) for path in (own, f"{own}_2"))
    assert (before["lensName"], copy["lensName"]) == ("", "Telephoto 250 mm f/5.6")
    assert before["horizontalApertureMm"] != copy["horizontalApertureMm"] == pytest.approx(22.0)


def key_times(service: str) -> list[float]:
    return [key["time"] for key in read(service, "camera/place", time=1)["keys"]]


def test_a_key_is_seen_taken_away_and_brought_back(page: Page, service: str) -> None:
    wait_settled(page, time=1)
    ways, times = way(service), key_times(service)
    keys = page.locator(".lane-run")  # one button: they stand too close for a pointer
    expect(keys).to_have_attribute("title", "96 keys, frames 1 to 96, of the shot")
    page.keyboard.press("Alt+k")
    wait_undo(page, "Key the camera")
    expect(keys).to_have_attribute("title", "96 keys, frames 1 to 96, of the edits")
    page.keyboard.press("Alt+Shift+K")
    wait_undo(page, "Take the camera’s key away")
    expect(keys).to_have_attribute("title", "95 keys, frames 2 to 96, of the edits")
    assert key_times(service) == times[1:]
    assert way(service)[0] == pytest.approx(ways[1])
    page.keyboard.press("Control+z")
    expect(keys).to_have_attribute("title", "96 keys, frames 1 to 96, of the edits")
    assert key_times(service) == times
    page.keyboard.press("Shift+E")
    page.get_by_role("button", name="Shot’s place").click()
    expect(keys).to_have_attribute("title", "96 keys, frames 1 to 96, of the shot")
    expect(page.get_by_role("button", name="Shot’s place")).to_have_count(0)
    assert way(service) == pytest.approx(ways)


def test_a_subject_is_framed_in_the_middle(page: Page, service: str) -> None:
    wait_settled(page, time=1)
    before = pose(service, 1)[1]
    page.locator(".lane-name", has_text=FAR).click()
    page.keyboard.press("Shift+X")
    wait_undo(page, f"Frame {FAR}")
    place, ahead = pose(service, 1)
    assert ahead == pytest.approx(before, abs=1e-9)
    point = focus_points(service, 1)[FAR]
    assert point["screen"] == pytest.approx((0.5, 0.5), abs=1 / 3)  # somewhere on the subject
    assert np.linalg.norm(point["positionM"] - place) < 3
