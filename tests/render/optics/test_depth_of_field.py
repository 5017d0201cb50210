"""Depth of field: the limits are where the circle of confusion reaches the limit, and the textbook comes out."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from render.errors import SettingsError
from render.optics.depth_of_field import coc_slope_mm_m, default_coc_limit_mm, depth_of_field

focal_lengths_mm = st.floats(8, 600)
f_stops = st.floats(0.7, 45)
focus_distances_m = st.floats(1.0, 1e4)
limits_mm = st.floats(0.005, 0.2)


def coc_mm(focal_length_mm: float, f_stop: float, focus_m: float, depth_m: float, *, breathing: bool = False) -> float:
    """The physical circle of confusion of a thin lens, by its image distances: A · |v' − v| / v', in mm on the film.

    Without breathing the film is scaled back to the focal length, as a USD camera's picture is.
    """
    f, s = focal_length_mm, focus_m * 1000
    film = f * s / (s - f)
    image = f * depth_m * 1000 / (depth_m * 1000 - f)
    physical = f / f_stop * abs(image - film) / image
    return physical if breathing else physical * f / film


@given(focal_lengths_mm, f_stops, focus_distances_m, limits_mm, st.booleans())
def test_the_circle_of_confusion_at_near_and_far_is_the_limit(f, n, s, limit, breathing):
    dof = depth_of_field(f, n, s, limit, breathing=breathing)
    assume(dof.near_m * 1000 > 2 * f)  # the physical formula needs a real image
    assert dof.near_m < s < dof.far_m
    assert coc_mm(f, n, s, dof.near_m, breathing=breathing) == pytest.approx(limit, rel=1e-6)
    if math.isfinite(dof.far_m):
        assert coc_mm(f, n, s, dof.far_m, breathing=breathing) == pytest.approx(limit, rel=1e-6)


@given(focal_lengths_mm, f_stops, focus_distances_m, limits_mm)
def test_a_breathing_lens_has_the_textbooks_limits(f, n, s, limit):
    dof = depth_of_field(f, n, s, limit, breathing=True)
    s_mm, h = s * 1000, f * f / (n * limit) + f
    assert dof.hyperfocal_m * 1000 == pytest.approx(h, rel=1e-9)
    assert dof.near_m * 1000 == pytest.approx(s_mm * (h - f) / (h + s_mm - 2 * f), rel=1e-9)
    if s_mm < h * (1 - 1e-6):
        assert dof.far_m * 1000 == pytest.approx(s_mm * (h - f) / (h - s_mm), rel=1e-6)


@given(focal_lengths_mm, f_stops, limits_mm)
def test_hyperfocal_focus_is_sharp_from_half_of_it_to_infinity(f, n, limit):
    hyperfocal_m = depth_of_field(f, n, 5.0, limit).hyperfocal_m
    dof = depth_of_field(f, n, hyperfocal_m * (1 + 1e-9), limit)
    assert dof.near_m == pytest.approx(hyperfocal_m / 2, rel=1e-6)
    assert dof.far_m == math.inf
    assert math.isfinite(depth_of_field(f, n, hyperfocal_m * 0.999, limit).far_m)


@given(focal_lengths_mm, f_stops, limits_mm)
def test_focus_at_infinity_is_sharp_from_the_hyperfocal_distance(f, n, limit):
    for infinity in (0.0, math.inf):
        dof = depth_of_field(f, n, infinity, limit)
        assert dof.near_m == pytest.approx(dof.hyperfocal_m)
        assert dof.far_m == math.inf


def test_a_pinhole_is_sharp_everywhere():
    dof = depth_of_field(50, 0, 3.0, 0.03)
    assert (dof.near_m, dof.far_m, dof.hyperfocal_m) == (0.0, math.inf, 0.0)


def test_a_known_lens():
    """50 mm, f/2.8, 5 m, 0.029 mm: the tables of the trade print about 30.8 m, 4.3 m and 5.97 m."""
    dof = depth_of_field(50, 2.8, 5.0, 0.029, breathing=True)
    assert dof.hyperfocal_m == pytest.approx(30.84, abs=0.01)
    assert dof.near_m == pytest.approx(4.31, abs=0.01)
    assert dof.far_m == pytest.approx(5.96, abs=0.01)


def test_the_usual_limit_of_a_full_frame_gate():
    assert default_coc_limit_mm(36, 24) == pytest.approx(0.0288, abs=1e-4)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ((-50, 2.8, 5, 0.03), "focal length"),
        ((0, 2.8, 5, 0.03), "focal length"),
        ((math.nan, 2.8, 5, 0.03), "focal length"),
        ((50, -1, 5, 0.03), "f-number"),
        ((50, math.inf, 5, 0.03), "f-number"),
        ((50, 2.8, -1, 0.03), "focus distance"),
        ((50, 2.8, math.nan, 0.03), "focus distance"),
        ((50, 2.8, 5, 0), "circle of confusion"),
        ((50, 2.8, 5, math.nan), "circle of confusion"),
    ],
)
def test_impossible_lenses_are_named(arguments, named):
    with pytest.raises(SettingsError, match=named):
        depth_of_field(*arguments)


def test_a_breathing_lens_cannot_focus_inside_its_focal_length():
    with pytest.raises(SettingsError, match=r"0\.04 m"):
        coc_slope_mm_m(50, 2.8, 0.04, breathing=True)


def test_an_impossible_gate_is_named():
    with pytest.raises(SettingsError, match="vertical aperture"):
        default_coc_limit_mm(36, -24)
