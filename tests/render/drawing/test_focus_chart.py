"""Charts of pulls: strips that say when points are sharp."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO
import pytest
from matplotlib.colors import to_rgb

from render.drawing.focus_chart import MOST_STRIPS, SHARP, SOFT, FocusTrack, PointTrack, draw_focus_chart, runs

FRAMES = np.arange(1, 41)


def track(points: list[PointTrack], focus_m: float = 3.0) -> FocusTrack:
    focus = np.full(len(FRAMES), focus_m)
    return FocusTrack(FRAMES, focus, 0.9 * focus, np.full(len(FRAMES), np.inf), points)


def point(judged: np.ndarray, sharp: np.ndarray, name: str = "pip") -> PointTrack:
    return PointTrack(name, np.full(len(FRAMES), 2.5), judged, sharp)


def share_of(colour: str, points: list[PointTrack], folder: Path) -> float:
    """Share of the picture that has a colour."""
    path = folder / "chart.png"
    path.write_bytes(draw_focus_chart(track(points), "png"))
    pixels = np.asarray(OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.FLOAT))[..., :3]
    return float((np.abs(pixels - np.array(to_rgb(colour))).max(axis=2) < 0.01).mean())


@pytest.mark.parametrize(
    ("chosen", "expected"), [("", []), ("...", []), ("##.", [(0, 1)]), (".#.##", [(1, 1), (3, 4)]), ("#", [(0, 0)])]
)
def test_runs_are_first_and_last_indices(chosen: str, expected: list[tuple[int, int]]) -> None:
    assert list(runs(np.array([mark == "#" for mark in chosen], bool))) == expected


def test_strips_are_coloured_by_the_frames_that_they_cover(tmp_path: Path) -> None:
    whole = share_of(SHARP, [point(FRAMES > 0, FRAMES > 0)], tmp_path)
    points = [point(FRAMES > 10, FRAMES <= 30)]
    assert share_of(SHARP, points, tmp_path) == pytest.approx(whole / 2, rel=0.03)
    assert share_of(SOFT, points, tmp_path) == pytest.approx(whole / 4, rel=0.03)


@pytest.mark.parametrize("focus_m", [np.inf, 1e-9, 1e7])
def test_a_chart_is_drawn_of_any_distance(focus_m: float) -> None:
    behind = PointTrack("<b>&$x$", np.full(len(FRAMES), -1.0), FRAMES > 0, FRAMES > 0)
    missing = PointTrack("missing", np.full(len(FRAMES), np.nan), FRAMES < 0, FRAMES < 0)
    drawing = draw_focus_chart(track([behind, missing], focus_m), "svg").decode()
    assert "&lt;b&gt;&amp;$x$" in drawing


def test_more_points_than_strips_stay_readable() -> None:
    points = [point(FRAMES > 0, FRAMES > 0, f"p{number}") for number in range(MOST_STRIPS + 5)]
    assert draw_focus_chart(track(points), "svg") == draw_focus_chart(track(points), "svg")
