"""The lens read off at a place of the picture: the same focal surface and the same circle of confusion as everywhere."""

import math

import pytest

from render.errors import InputError, NotFoundError, SettingsError
from render.shot import Shot
from tests.render.kits.focus_shot import CAMERA, FAR, NEAR, write_shot
from usd_schemas import FocusPoint

MIDDLE = (0.5, 0.0, 0.5)
NEAR_M, FAR_M, FOCUS_M, FOCAL_MM, F_STOP = 4.0, 10.0, 3.0, 50.0, 2.0


@pytest.fixture
def shot(tmp_path):
    return Shot.open(write_shot(tmp_path / "shot.usda"))


def circle_mm(depth_m):
    """Circle of confusion of the thin lens, film at the focal length: f² / N · |1/z - 1/z_f|."""
    return FOCAL_MM**2 / F_STOP / 1000 * abs(1 / depth_m - 1 / FOCUS_M)


@pytest.mark.parametrize("depth_m", [0.5, 3.0, 4.0, math.inf])
@pytest.mark.parametrize("screen", [(0.5, 0.5), (0.1, 0.9)])
def test_an_upright_plane_reads_the_same_everywhere(shot, screen, depth_m):
    read = shot.focus.read_at(CAMERA, 1, screen, depth_m)
    whole = shot.focus.read(CAMERA, 1)
    assert read.coc_mm == pytest.approx(circle_mm(depth_m), rel=1e-6, abs=1e-9)
    assert (read.near_m, read.far_m, read.focus_distance_m) == pytest.approx(
        (whole.near_m, whole.far_m, whole.focus_distance_m)
    )
    assert read.is_sharp == (whole.near_m <= depth_m <= whole.far_m)


def test_the_limits_of_a_place_are_where_its_circle_is_the_limit(shot):
    shot.focus.set(CAMERA, tilt_deg=-5.0, mode="tiltPlane", driven_by_points=False)
    screen = (0.5, 0.8)
    read = shot.focus.read_at(CAMERA, 1, screen, FOCUS_M)
    for depth_m in (read.near_m, read.far_m):
        assert shot.focus.read_at(CAMERA, 1, screen, depth_m).coc_mm == pytest.approx(read.coc_limit_mm)
    assert shot.focus.read_at(CAMERA, 1, screen, read.focus_distance_m).coc_mm == pytest.approx(0, abs=1e-9)


def test_a_tilted_plane_lies_nearer_below_than_above(shot):
    shot.focus.set(CAMERA, tilt_deg=-5.0, mode="tiltPlane", driven_by_points=False)
    below, middle, above = (shot.focus.read_at(CAMERA, 1, (0.5, y), 3.0).focus_distance_m for y in (0.9, 0.5, 0.1))
    assert below < middle < above
    assert middle == pytest.approx(FOCUS_M)
    half_height_slope = 0.4 * 20.25 / FOCAL_MM
    tilt = math.sin(math.radians(-5)) / (FOCAL_MM / 1000)
    assert 1 / below == pytest.approx(1 / FOCUS_M - tilt * half_height_slope)


def test_a_point_reads_as_its_place_does(shot):
    shot.focus.add_point(CAMERA, "near", FocusPoint("near", target=(NEAR,), face=0, barycentric=MIDDLE))
    shot.focus.add_point(CAMERA, "far", FocusPoint("far", target=(FAR,), face=0, barycentric=MIDDLE, enabled=False))
    placed = {place.point.name: place for place in shot.focus.points(CAMERA, 1)}
    for name, depth_m in (("near", NEAR_M), ("far", FAR_M)):
        read = shot.focus.read_at_point(CAMERA, 1, name)
        assert read.depth_m == pytest.approx(depth_m)
        assert read.coc_mm == pytest.approx(placed[name].coc_mm, abs=1e-12)
        assert read.screen == pytest.approx(placed[name].screen)
        again = shot.focus.read_at(CAMERA, 1, read.screen, read.depth_m)
        assert again.coc_mm == pytest.approx(read.coc_mm, abs=1e-9)
    assert shot.focus.read_at_point(CAMERA, 1, "near").is_sharp
    assert not shot.focus.read_at_point(CAMERA, 1, "far").is_sharp


def test_a_point_without_a_readout_is_reported(shot):
    shot.focus.add_point(CAMERA, "gone", FocusPoint("gone", target=("/World/gone",)))
    for screen, depth_m in (((0.5, 0.5), 0.0), ((0.5, 0.5), -1.0), ((0.5, 0.5), math.nan), ((math.nan, 0.5), 1.0)):
        with pytest.raises(SettingsError):
            shot.focus.read_at(CAMERA, 1, screen, depth_m)
    with pytest.raises(NotFoundError, match="nobody"):
        shot.focus.read_at_point(CAMERA, 1, "nobody")
    with pytest.raises(InputError, match="gone"):
        shot.focus.read_at_point(CAMERA, 1, "gone")
