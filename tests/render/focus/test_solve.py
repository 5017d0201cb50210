"""Solving for focus: the distance that blurs the points least, and honest words about whose it is."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import SettingsError
from render.focus import FocusTarget, solve_focus
from render.focus.solve import STATES

SLOPE_MM_M = 50.0 * 50.0 / 2.0 / 1000  # a 50 mm lens at f/2: 1.25 mm on the film for each 1/m

depths_m = st.floats(0.2, 1e4)
weights = st.floats(0.01, 100)
sharp_points = st.builds(FocusTarget, name=st.just("p"), depth_m=depths_m, weight=weights)
soft_points = st.builds(
    FocusTarget, name=st.just("s"), depth_m=depths_m, weight=weights, kind=st.just("soft"), blur_mm=st.floats(0.01, 2)
)


def energy(points, w):
    """Weighted squared error of the circles of confusion, in inverse depth."""
    w = np.asarray(w, float)
    total = np.zeros_like(w)
    for point in points:
        offset = point.blur_mm / SLOPE_MM_M if point.kind == "soft" else 0.0
        total += point.weight * (np.abs(w - 1 / point.depth_m) - offset) ** 2
    return total


@given(depths_m, weights)
def test_one_point_is_focused_exactly(depth, weight):
    solution = solve_focus([FocusTarget("hero", depth, weight)], 3.0)
    assert solution.focus_distance_m == pytest.approx(depth, rel=1e-12)
    assert solution.source == "points"
    assert solution.shares == (1.0,)
    assert "hero" in solution.reason


@given(depths_m, depths_m, st.floats(0, 1))
def test_a_cross_fade_of_weights_racks_evenly_in_blur(near, far, t):
    solution = solve_focus([FocusTarget("a", near, 1 - t), FocusTarget("b", far, t)])
    assert 1 / solution.focus_distance_m == pytest.approx((1 - t) / near + t / far, rel=1e-9)


@given(st.lists(st.one_of(sharp_points, soft_points), min_size=1, max_size=5), st.one_of(st.just(math.inf), depths_m))
def test_no_other_distance_has_less_error(points, own):
    solution = solve_focus(points, own, coc_slope_mm_m=SLOPE_MM_M)
    found = 1 / solution.focus_distance_m
    assert found >= 0
    others = np.concatenate([np.linspace(0, 8, 4001), found * np.array([0.999, 1.001])])
    rounding = 1e-11 * sum(p.weight * (1 / p.depth_m + p.blur_mm / SLOPE_MM_M) ** 2 for p in points)
    assert energy(points, found) <= energy(points, others).min() + rounding


@given(st.lists(sharp_points, min_size=1, max_size=6), st.floats(0.1, 1e6))
def test_only_the_ratio_of_weights_matters(points, factor):
    scaled = [FocusTarget(p.name, p.depth_m, p.weight * factor) for p in points]
    assert solve_focus(points).focus_distance_m == pytest.approx(solve_focus(scaled).focus_distance_m, rel=1e-9)


def test_a_soft_point_gets_its_blur_on_the_cameras_own_side():
    soft = FocusTarget("veil", 2.0, kind="soft", blur_mm=0.25)
    near = solve_focus([soft], 1.5, coc_slope_mm_m=SLOPE_MM_M)
    far = solve_focus([soft], 10.0, coc_slope_mm_m=SLOPE_MM_M)
    assert 1 / near.focus_distance_m == pytest.approx(0.5 + 0.2)
    assert 1 / far.focus_distance_m == pytest.approx(0.5 - 0.2)


def test_a_soft_point_blurred_beyond_infinity_is_focused_before():
    soft = FocusTarget("veil", 2.0, kind="soft", blur_mm=1.25)  # wants 1 / m on either side of 0.5 / m
    solution = solve_focus([soft], math.inf, coc_slope_mm_m=SLOPE_MM_M)
    assert 1 / solution.focus_distance_m == pytest.approx(1.5)


@pytest.mark.parametrize(
    ("point", "state"),
    [
        (FocusTarget("p", 2.0, enabled=False), "disabled"),
        (FocusTarget("p", 2.0, weight=0.0), "zero_weight"),
        (FocusTarget("p", math.nan), "lost"),
        (FocusTarget("p", -2.0), "behind_camera"),
        (FocusTarget("p", 0.0), "behind_camera"),
        (FocusTarget("p", 2.0, in_frame=False), "outside_frame"),
        (FocusTarget("p", 2.0, kind="soft", blur_mm=0.1), "pinhole"),
    ],
)
def test_a_point_that_does_not_count_leaves_focus_to_the_others(point, state):
    alone = solve_focus([point], 4.0)
    assert (alone.focus_distance_m, alone.source, alone.states) == (4.0, "camera", (state,))
    assert alone.shares == (0.0,)
    assert state.replace("_", " ") in alone.reason
    beside = solve_focus([point, FocusTarget("hero", 7.0)], 4.0)
    assert beside.focus_distance_m == pytest.approx(7.0)
    assert beside.shares == (0.0, 1.0)
    assert beside.states == (state, "used")
    assert state in STATES


def test_a_point_outside_the_picture_can_be_kept():
    solution = solve_focus([FocusTarget("p", 2.0, in_frame=False)], 4.0, keep_outside=True)
    assert solution.focus_distance_m == pytest.approx(2.0)


@given(depths_m, st.floats(-0.1, 10))
def test_a_point_can_be_soft_by_a_distance(depth, offset):
    solution = solve_focus([FocusTarget("p", depth, kind="soft", surface_offset_m=offset)])
    assert solution.focus_distance_m == pytest.approx(depth + offset, rel=1e-9)


def test_a_point_that_asks_for_focus_behind_the_camera_does_not_count():
    solution = solve_focus([FocusTarget("p", 2.0, kind="soft", surface_offset_m=-3.0)], 4.0)
    assert (solution.focus_distance_m, solution.states) == (4.0, ("behind_camera",))


@given(depths_m, depths_m, st.floats(0, 4))
def test_near_priority_weights_by_a_power_of_inverse_depth(a, b, power):
    solution = solve_focus([FocusTarget("a", a), FocusTarget("b", b)], near_priority=power)
    counts = np.array([a, b]) ** -power
    assert 1 / solution.focus_distance_m == pytest.approx(np.average([1 / a, 1 / b], weights=counts), rel=1e-9)
    assert solution.shares == pytest.approx(counts / counts.sum())


def test_extreme_weights_and_powers_stay_finite():
    points = [FocusTarget("a", 1e-3, 1e308), FocusTarget("b", math.inf, 1e-308), FocusTarget("c", 5.0, 1e308)]
    solution = solve_focus(points, near_priority=300.0)
    assert solution.focus_distance_m == pytest.approx(1e-3)
    assert sum(solution.shares) == pytest.approx(1.0)


def test_without_points_the_camera_decides_and_says_so():
    solution = solve_focus([], 4.0)
    assert (solution.focus_distance_m, solution.source) == (4.0, "camera")
    assert "no focus point" in solution.reason
    assert solve_focus([], 0.0).focus_distance_m == math.inf


def test_a_point_at_infinity_focuses_at_infinity():
    assert solve_focus([FocusTarget("moon", math.inf)], 4.0).focus_distance_m == math.inf


@pytest.mark.parametrize("bad", [math.nan, math.inf, -1.0])
def test_impossible_weights_and_blurs_are_named(bad):
    with pytest.raises(SettingsError, match="weight of focus point 'hero'"):
        solve_focus([FocusTarget("hero", 2.0, weight=bad)])
    with pytest.raises(SettingsError, match="blur in mm of focus point 'hero'"):
        solve_focus([FocusTarget("hero", 2.0, blur_mm=bad)])
    if not math.isfinite(bad):
        with pytest.raises(SettingsError, match="surface offset in m of focus point 'hero'"):
            solve_focus([FocusTarget("hero", 2.0, surface_offset_m=bad)])
    with pytest.raises(SettingsError, match="near priority"):
        solve_focus([FocusTarget("hero", 2.0)], near_priority=bad)
