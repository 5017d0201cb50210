"""A dense curve in a real browser: imported, corrected without a spike, and made few keys, by mouse and by keyboard."""

from __future__ import annotations

import math
import re
from pathlib import Path

import httpx
import numpy as np
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.editor import choose_file, revision_of, scrub_to, tab_to, wait_edited, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

FRAMES = np.arange(1, 97)


def rack_m(time: float) -> float:
    """Distance of a rack by hand, with the tremor of a hand, m."""
    share = np.clip((time - 30) / 28, 0, 1)
    w = 1 / 2.65 + (1 / 8.6 - 1 / 2.65) * share**2 * (3 - 2 * share)
    return float((1 + 0.004 * math.sin(1.7 * time)) / w)


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    """A file of a curve with a distance for each frame."""
    rows = "".join(f"{frame},{rack_m(frame):.6f}\n" for frame in FRAMES)
    file = tmp_path / "recorded.csv"
    file.write_text(f"frame,focus_distance_m\n{rows}")
    return file


@pytest.fixture
def imported(page: Page, service: str, recorded: Path) -> int:
    """The revision after the import of the curve."""
    wait_settled(page)
    revision = revision_of(page)
    choose_file(page, recorded, "Import…")
    revision = wait_edited(page, revision)
    expect(page.get_by_role("button", name="Focus distance", exact=True)).to_be_visible()
    return revision


def test_a_value_on_a_dense_curve_makes_no_spike(page: Page, service: str, imported: int) -> None:
    scrub_to(page, 20)
    revision = set_distance(page, "3 m", imported)
    bent = distances_m(service)
    assert bent[19] == pytest.approx(3, abs=1e-4)
    assert steps_of(bent[6:32]).max() < 0.25 * abs(1 / 3 - 1 / rack_m(20))
    assert changed(bent) == (9, 31)

    width = page.get_by_role("textbox", name="Frames that are bent to each side")
    width.fill("5")
    width.press("Enter")
    wait_edited(page, revision)
    assert distances_m(service)[19] == pytest.approx(3, abs=1e-4)
    assert changed(distances_m(service)) == (16, 24)
    undo_all(page)


def test_a_dense_curve_is_simplified_and_corrected(page: Page, service: str, imported: int) -> None:
    page.get_by_role("button", name="Focus distance", exact=True).click()
    page.get_by_role("button", name="Simplify").click()
    wait_edited(page, imported)
    few = keys(service)
    assert 2 <= len(few) <= 8
    expect(page.get_by_text(re.compile(rf"^{len(few)} of \d+ keys, at most [\d.]+ % off$"))).to_be_visible()
    assert np.abs(distances_m(service) / np.array([rack_m(time) for time in FRAMES]) - 1).max() <= 0.02
    expect(page.locator(".lane-key.selected")).to_have_count(len(few))
    page.keyboard.press("Escape")
    scrub_to(page, 80)
    set_distance(page, "7 m", revision_of(page))
    assert len(keys(service)) == len(few) + 1
    assert distances_m(service)[79] == pytest.approx(7, abs=1e-4)
    undo_all(page)


def test_the_keyboard_alone_imports_simplifies_and_corrects(page: Page, service: str, recorded: Path) -> None:
    with page.expect_file_chooser() as chooser:  # from here on, as the browser takes a moment to pass choosers on
        wait_settled(page)
        revision = revision_of(page)
        page.keyboard.press("Alt+i")
    chooser.value.set_files(recorded)
    revision = wait_edited(page, revision)
    tab_to(page, page.get_by_role("button", name="Focus distance", exact=True))
    page.keyboard.press("Enter")
    page.keyboard.press("Shift+U")
    revision = wait_edited(page, revision)
    few = keys(service)
    assert 2 <= len(few) <= 8
    assert np.abs(distances_m(service) / np.array([rack_m(time) for time in FRAMES]) - 1).max() <= 0.02

    page.keyboard.press("Control+z")
    revision = wait_edited(page, revision)
    page.keyboard.press("Escape")
    for _ in range(2):
        page.keyboard.press("Shift+ArrowRight")
    wait_settled(page, time=21)
    tab_to(page, page.get_by_role("textbox", name="Focus distance", exact=True))
    page.keyboard.type("3 m")
    page.keyboard.press("Enter")
    wait_edited(page, revision)
    bent = distances_m(service)
    assert bent[20] == pytest.approx(3, abs=1e-4)
    assert changed(bent) == (10, 32)
    undo_all(page)


def set_distance(page: Page, text: str, revision: int) -> int:
    """Type a focus distance, and return the revision that has it."""
    box = page.get_by_role("textbox", name="Focus distance", exact=True)
    box.fill(text)
    box.press("Enter")
    return wait_edited(page, revision)


def undo_all(page: Page) -> None:
    """Undo every edit, so that the next test begins with the demo as it was."""
    undo = page.get_by_role("button", name="Undo")
    while undo.is_enabled():
        revision = revision_of(page)
        undo.click()
        wait_edited(page, revision)


def keys(service: str) -> list[dict]:
    """Return the keys of the focus distance."""
    return httpx.get(f"{service}/v1/shots/demo/camera/focus", params={"time": 1}, timeout=120).json()["keys"][
        "focusDistanceM"
    ]


def distances_m(service: str) -> np.ndarray:
    """Return the focus distance of each frame, m."""
    curve = httpx.get(f"{service}/v1/shots/demo/focus-curve", timeout=120).json()
    return np.array([sample["focusDistanceM"] for sample in curve["samples"]])


def changed(distances: np.ndarray) -> tuple[int, int]:
    """Return the first and last frame whose distance is not the imported one."""
    off = np.abs(distances - np.array([rack_m(time) for time in FRAMES])) > 1e-4
    return int(FRAMES[off][0]), int(FRAMES[off][-1])


def steps_of(distances: np.ndarray) -> np.ndarray:
    """Return the change of the inverse distance from each frame to the next, 1/m."""
    return np.abs(np.diff(1 / distances))
