"""Motion: what moves while the shutter is open leaves a trail of the right length, brightness and shape."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from pxr import Gf, Usd, UsdGeom

from render.errors import SettingsError
from render.film import Grade
from render.frame import FrameRenderer
from render.model.shutter import Shutter, moments, moments_per_pixel, shares
from render.pictures.picture import make_picture
from render.shot import Shot
from tests.render.kits.moving_shots import STILL, coverage, write_moving
from usd_schemas import Shutter as ShutterData

WIDTH, HEIGHT = 240, 120


def test_a_trail_is_as_long_as_the_way_and_as_bright_as_the_time(renderer: FrameRenderer, tmp_path: Path) -> None:
    """Half a frame is 50 pixels: a card of 20 covers 70, and each of the middle 30 for 20 / 50 of the time."""
    shot = Shot.open(write_moving(tmp_path / "moving.usda"))
    still, moving = coverage(renderer, shot, 1), coverage(renderer, shot, 50)
    assert moving.sum() == pytest.approx(still.sum(), rel=0.01)
    row = moving[HEIGHT // 2]
    lit = np.flatnonzero(row > 0.005)
    assert lit[-1] - lit[0] + 1 == pytest.approx(70, abs=2)
    middle = row[lit[0] + 22 : lit[0] + 48]
    assert middle == pytest.approx(0.4, abs=0.025)
    assert moving.std(axis=0).max() < 0.02  # every line at once: one moment of 50, as rays fall


def test_a_rolling_shutter_leans_what_moves(renderer: FrameRenderer, tmp_path: Path) -> None:
    """Lines that are read one after the other over half a frame see the card 50 pixels farther on in the last than the first."""
    rolling = ShutterData(type="rolling", direction="down", travel_s=0.5 / 24)
    shot = Shot.open(write_moving(tmp_path / "rolling.usda", shutter=rolling, closes=0.02))
    seen = coverage(renderer, shot, 104)
    middles = (seen * np.arange(WIDTH)).sum(axis=1) / seen.sum(axis=1)
    lean = np.polyfit(np.arange(HEIGHT), middles, 1)[0]
    assert lean * HEIGHT == pytest.approx(50, rel=0.02)
    straight = np.polyval(np.polyfit(np.arange(HEIGHT), middles, 1), np.arange(HEIGHT))
    assert np.abs(middles - straight).max() < 1


SPOKES, TURN_DEG = 6, 120.0  # of the wheel, and how far it turns in a frame


def write_wheel(path: Path, shutter: ShutterData) -> Path:
    """A wheel of thin white spokes, 1 m in radius, 2 m before a pinhole that sees 2.4 by 1.2 m there; it turns anticlockwise."""
    stage = Usd.Stage.Open(str(write_moving(path, shutter=shutter, closes=0.002)))
    stage.RemovePrim("/card")
    wheel = UsdGeom.Mesh.Define(stage, "/wheel")
    points, half = [], 0.012
    for angle in 2 * np.pi * np.arange(SPOKES) / SPOKES:
        along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        points += [r * along + side * half * across for r, side in ((0.1, -1), (1.0, -1), (1.0, 1), (0.1, 1))]
    wheel.CreatePointsAttr([Gf.Vec3f(float(x), float(y), -2) for x, y in points])
    wheel.CreateFaceVertexCountsAttr([4] * SPOKES)
    wheel.CreateFaceVertexIndicesAttr(list(range(4 * SPOKES)))
    wheel.CreateDisplayColorAttr([Gf.Vec3f(1, 1, 1)])
    turns = wheel.AddRotateZOp()
    for frame in (1, 3):
        turns.Set(TURN_DEG * (frame - 1), frame)
    stage.Save()
    return path


def test_a_rolling_shutter_bends_the_spokes_of_a_wheel(renderer: FrameRenderer, tmp_path: Path) -> None:
    """A line that is read at the share s of half a frame sees the wheel turned by s / 2 of its turn: the spoke at the angle
    θ when the shutter opens is met on that line where φ = θ + ω·t(line), and nowhere else."""
    rolling = ShutterData(type="rolling", direction="up", travel_s=0.5 / 24)
    shot = Shot.open(write_wheel(tmp_path / "wheel.usda", rolling))
    seen = coverage(renderer, shot, 100)
    line, column = np.nonzero(seen > 0.6)
    x, y = (column + 0.5 - WIDTH / 2) / 100, (HEIGHT / 2 - line - 0.5) / 100  # metres at the wheel
    radius = np.hypot(x, y)
    whole = (radius > 0.25) & (radius < 0.58)
    read = 1 - (line + 0.5) / HEIGHT
    turned = np.degrees(np.arctan2(y, x)) - 0.5 * TURN_DEG * read
    off = (turned + 180 / SPOKES) % (360 / SPOKES) - 180 / SPOKES
    beside = np.abs(radius * np.sin(np.radians(off)))[whole]
    assert np.count_nonzero(whole) > 400
    assert beside.max() < 0.012 + 0.012, "within a pixel or so of the bent spoke"
    straight = (np.degrees(np.arctan2(y, x)) + 180 / SPOKES) % (360 / SPOKES) - 180 / SPOKES
    assert np.abs(radius * np.sin(np.radians(straight)))[whole].max() > 0.1, "and not of the straight one"


def test_blades_that_open_slowly_soften_the_ends_of_a_trail(renderer: FrameRenderer, tmp_path: Path) -> None:
    leaf = ShutterData(type="leaf", efficiency=(0.0, 1.0, 0.0))
    shot = Shot.open(write_moving(tmp_path / "leaf.usda", shutter=leaf))
    row = coverage(renderer, shot, 50)[HEIGHT // 2]
    lit = np.flatnonzero(row > 1e-4)
    middle = (lit[0] + lit[-1]) // 2
    quick = 2 * (20 / 50) - (20 / 50) ** 2  # the 20 / 50 of the time around the middle, of a triangle's light
    assert row[middle] == pytest.approx(quick, abs=0.03)
    assert row[lit[0] + 10] < 0.15


def test_depth_of_field_and_motion_are_one_integral(renderer: FrameRenderer, tmp_path: Path) -> None:
    """As many rays spread over the moments see the same as the mean of many frames with all rays."""
    path = write_moving(tmp_path / "both.usda")
    stage = Usd.Stage.Open(str(path))
    camera = UsdGeom.Camera.Get(stage, "/cam")
    camera.CreateFStopAttr(0.5)
    camera.CreateFocusDistanceAttr(1.0)
    stage.Save()
    shot, settings = Shot.open(path), replace(STILL, engine="lens", rays=64)
    moving = make_picture(renderer, shot, "/cam", 1.0, replace(settings, motion=16), Grade()).frame.color
    stills = []
    for time in 1.0 + 0.5 * (np.arange(16) + 0.5) / 16:
        camera_then = shot.camera_at("/cam", float(time), WIDTH, HEIGHT)
        stills.append(renderer.render(shot.scene_at(float(time)), camera_then, settings).color)
    mean = np.mean(stills, axis=0)
    still = renderer.render(shot.scene_at(1.25), shot.camera_at("/cam", 1.25, WIDTH, HEIGHT), settings).color
    assert np.abs(moving - mean).mean() < 0.1 * np.abs(still - mean).mean()
    assert moving.mean() == pytest.approx(mean.mean(), rel=0.005)


def test_a_still_shot_is_the_same_however_often_it_is_looked_at(renderer: FrameRenderer, tmp_path: Path) -> None:
    shot = Shot.open(write_moving(tmp_path / "still.usda", closes=0.0))
    np.testing.assert_array_equal(coverage(renderer, shot, 8), coverage(renderer, shot, 1))


def test_a_shutter_that_closes_before_it_opens_is_one_clear_error(renderer: FrameRenderer, tmp_path: Path) -> None:
    shot = Shot.open(write_moving(tmp_path / "wrong.usda", closes=-0.5))
    with pytest.raises(Exception, match="cannot close before it opens"):
        coverage(renderer, shot, 8)


@example(1.0, 4e-16, "rolling", "down", 1.0, 7, [])
@example(0.0, 2.2e-309, "rolling", "down", 1.0, 7, [])
@given(
    st.floats(-1, 1),
    st.floats(0, 2),
    st.sampled_from(["global", "rolling", "focalPlane", "leaf"]),
    st.sampled_from(["down", "up", "left", "right"]),
    st.floats(0, 2),
    st.integers(1, 40),
    st.lists(st.floats(0, 1), max_size=5),
)
def test_every_place_gets_all_of_its_light(opens, length, kind, direction, travel, count, efficiency) -> None:  # type: ignore[no-untyped-def]
    if efficiency and not any(value > 1e-3 for value in efficiency):
        efficiency = []
    shutter = Shutter(kind, direction, travel, tuple(efficiency))
    parts = shares(opens, opens + length, shutter, count, 7, 5)
    assert parts.min() >= -1e-12
    np.testing.assert_allclose(parts.sum(axis=0), 1.0, rtol=1e-9)
    when = moments(opens, opens + length, shutter, count)
    assert opens <= when[0] <= when[-1] <= opens + length + shutter.delay + 1e-12


def test_impossible_shutters_are_refused() -> None:
    for wrong in ({"travel": -1.0}, {"efficiency": (0.0, 0.0)}, {"efficiency": (-1.0, 1.0)}):
        with pytest.raises(SettingsError, match="shutter"):
            Shutter(**wrong)  # type: ignore[arg-type]


def test_where_lines_are_bared_one_by_one_each_has_all_of_its_rays() -> None:
    """A slit that bares a line for a quarter of the way's time shows it at a quarter of the moments, not at all of them."""
    slit = Shutter("focalPlane", "down", travel=0.75)
    parts = shares(0.0, 0.25, slit, 16, 8, 64)
    assert moments_per_pixel(parts) == 5  # four, and one that is cut at both ends
    assert moments_per_pixel(shares(0.0, 0.25, Shutter(), 16, 8, 64)) == 16
    assert moments_per_pixel(shares(0.0, 0.0, slit, 16, 8, 64)) == 1
