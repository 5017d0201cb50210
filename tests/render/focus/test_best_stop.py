"""The best stop: the widest f-number that holds points, and the split between them."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from render.errors import SettingsError
from render.focus.best_stop import Split, split, stops_for
from render.focus.points import FocusTargets
from render.model.lens_law import LensLaw
from render.optics.depth_of_field import coc_slope_mm_m, depth_of_field

FOCAL_MM, LIMIT_MM = 50.0, 0.03
THIN = LensLaw.thin(FOCAL_MM, 2.0)
depths_m = st.floats(0.3, 1e4)
seeds = st.integers(0, 2**31)


def split_two(
    near_w: float, far_w: float, *, breathing: bool = False, camera_f_stop: float = 0.0, f_stop_range=(0.0, 0.0)
) -> Split:
    """Split a thin lens between two points at inverse depths in 1/m, both of which may have `LIMIT_MM`."""
    law = LensLaw.thin(FOCAL_MM, camera_f_stop, breathing=breathing)
    return split([[near_w, far_w]], LIMIT_MM, law, f_stop_range=f_stop_range)


@given(depths_m, depths_m, st.booleans())
def test_two_points_are_the_near_and_far_limit_of_depth_of_field(a_m, b_m, breathing):
    assume(max(a_m, b_m) / min(a_m, b_m) > 1.05)
    found = split_two(1 / a_m, 1 / b_m, breathing=breathing)
    assume(found.f_stops[0] > 0.51)
    field = depth_of_field(FOCAL_MM, found.f_stops[0], 1 / found.w[0], LIMIT_MM, breathing=breathing)
    assert field.near_m == pytest.approx(min(a_m, b_m), rel=1e-6)
    assert 1 / field.far_m == pytest.approx(1 / max(a_m, b_m), rel=1e-6, abs=1e-9)
    assert found.holds[0]
    assert found.excess[0] == pytest.approx(1)


def test_a_point_at_infinity_focuses_at_the_hyperfocal_distance():
    found = split_two(1 / 4.0, 0.0)
    field = depth_of_field(FOCAL_MM, found.f_stops[0], 8.0, LIMIT_MM)
    assert 1 / found.w[0] == pytest.approx(8.0)
    assert field.hyperfocal_m == pytest.approx(8.0)


@given(seeds)
@settings(max_examples=60)
def test_no_other_focus_holds_the_points_at_a_wider_stop(seed):
    rng = np.random.default_rng(seed)
    w, circles = rng.uniform(0, 3, (1, 6)), rng.uniform(0.01, 0.4, (1, 6))
    counting = rng.random((1, 6)) < 0.8
    assume(counting.sum() > 1)
    law = LensLaw.thin(FOCAL_MM, 4.0, breathing=bool(seed % 2))
    found = split(w, circles, law, counting=counting)

    def needed(x):
        return law.slope_at_f1_mm_m(x) * np.max(np.abs(w[counting] - x[:, None]) / circles[counting], axis=1)

    assert found.f_stops[0] == pytest.approx(max(needed(found.w)[0], 0.5))
    assert needed(found.w)[0] <= needed(np.linspace(0, 3, 1001)).min() * (1 + 1e-9)
    assert found.decides.sum() == pytest.approx(1)
    assert (found.decides * w).sum() == pytest.approx(found.w[0])
    assert not found.decides[~counting].any()


def test_many_frames_are_split_as_each_by_itself():
    rng = np.random.default_rng(3)
    w, circles = rng.uniform(0, 3, (50, 20)), rng.uniform(0.01, 0.4, (50, 20))
    law = LensLaw.thin(np.linspace(20, 90, 50), 2.0)
    together = split(w, circles, law)
    for i in range(50):
        alone = split(w[i : i + 1], circles[i : i + 1], LensLaw.thin(np.linspace(20, 90, 50)[i], 2.0))
        assert (together.w[i], together.f_stops[i]) == pytest.approx((alone.w[0], alone.f_stops[0]))


def test_the_iris_has_two_ends():
    wide = split_two(0.5, 0.49, f_stop_range=(1.4, 16))
    assert (wide.f_stops[0], bool(wide.holds[0])) == (1.4, True)
    assert wide.excess[0] < 1
    narrow = split_two(3.0, 0.1, f_stop_range=(1.4, 16))
    assert (narrow.f_stops[0], bool(narrow.holds[0])) == (16, False)
    circle_mm = coc_slope_mm_m(FOCAL_MM, 16) * 1.45
    assert narrow.excess[0] == pytest.approx(circle_mm / LIMIT_MM)
    assert split_two(0.5, 0.5, camera_f_stop=5.6).f_stops[0] == 5.6


def test_a_lens_that_does_not_reach_the_split_stops_down_for_it():
    law = LensLaw.thin(FOCAL_MM, 2.0, near_w=1.0)
    found = split([[4.0, 0.5]], LIMIT_MM, law)
    assert found.w[0] == 1.0
    assert found.limits[0] == 1
    assert found.f_stops[0] == pytest.approx(law.slope_at_f1_mm_m([1.0])[0] * 3 / LIMIT_MM)


def test_each_point_keeps_to_its_own_blur_or_to_the_limit():
    targets = FocusTargets.from_columns(
        ["hero", "friend", "veil"], [2.0, 3.0, 8.0], kinds=["sharp", "sharp", "soft"], blurs_mm=[0.0, 0.05, 0.5]
    )
    found = stops_for(targets, THIN, LIMIT_MM)
    w, slope = found.focus.focus_w[0], coc_slope_mm_m(FOCAL_MM, found.f_stops[0])
    circles = slope * np.abs(targets.aims_w[0] - w)
    allowed = np.array([LIMIT_MM, 0.05, 0.5])
    assert (circles <= allowed * (1 + 1e-9)).all()
    assert np.sum(circles >= allowed * (1 - 1e-9)) == 2
    assert found.holds[0]
    assert "split between hero and friend" in found.focus.reasons[0]


def test_a_point_that_fades_out_lets_go_of_focus_and_stop_smoothly():
    fades = np.linspace(1, 0, 2001)
    targets = FocusTargets.from_columns(
        "abc", np.tile([2.0, 2.5, 6.0], (len(fades), 1)), visible=fades[:, None] ** [0, 0, 1]
    )
    found = stops_for(targets, THIN, LIMIT_MM, occluded="fade")
    assert found.f_stops[-1] == pytest.approx(split_two(0.5, 0.4).f_stops[0])
    assert found.focus.states[-1, 2] == "hidden"
    assert np.abs(np.diff(found.f_stops)).max() < 0.01 * found.f_stops[0]
    assert np.abs(np.diff(found.focus.focus_w)).max() < 1e-3


def test_without_points_the_camera_keeps_focus_and_stop():
    targets = FocusTargets.from_columns("a", [[2.0], [2.0]], enabled=[[False], [True]])
    found = stops_for(targets, LensLaw.thin(FOCAL_MM, 2.8), LIMIT_MM, camera_distances_m=[7.0, 7.0])
    assert found.focus.at(0).source == "camera"
    assert found.focus.focus_distance_m == pytest.approx([7.0, 2.0])
    assert found.f_stops == pytest.approx([2.8, 2.8])
    assert "disabled" in found.focus.reasons[0]
    none = FocusTargets.from_columns([], np.empty((3, 0)))
    assert stops_for(none, THIN, LIMIT_MM).focus.sources == ("camera",) * 3
    assert stops_for(none, THIN, LIMIT_MM).focus.focus_distance_m.tolist() == [math.inf] * 3


def test_points_beyond_the_reach_of_the_iris_are_reported():
    targets = FocusTargets.from_columns("ab", [0.4, 8.0])
    found = stops_for(targets, THIN, LIMIT_MM, f_stop_range=(1.4, 22))
    assert not found.holds[0]
    assert "as far as the lens stops down" in found.focus.reasons[0]


def test_impossible_numbers_are_refused():
    with pytest.raises(SettingsError, match="circles of confusion"):
        split([[1.0, 0.5]], 0.0, THIN)
    with pytest.raises(SettingsError, match="wide open to stopped down"):
        split([[1.0, 0.5]], LIMIT_MM, THIN, f_stop_range=(8, 2))
    with pytest.raises(SettingsError, match="focus law of 2 frames"):
        stops_for(FocusTargets.from_columns("a", [1.0]), LensLaw.thin([50.0, 60.0], 2.0), LIMIT_MM)


def test_through_a_tilted_lens_the_split_is_about_its_plane():
    """Points on a tilted plane need no stop at all; those off it, as much as were the plane upright."""
    tilt = np.array([[0.4, -1.5]])
    slopes = np.array([[[0.1, -0.2], [-0.2, 0.0], [0.0, 0.1]]])
    off = np.array([0.02, -0.01, 0.0])
    w = 0.5 + off + (slopes * tilt[:, None]).sum(-1)
    targets = FocusTargets.from_columns("abc", 1 / w, slopes=slopes)
    found = stops_for(targets, THIN, LIMIT_MM, tilts=tilt)
    upright = stops_for(FocusTargets.from_columns("abc", [1 / (0.5 + off)]), THIN, LIMIT_MM)
    assert found.f_stops == pytest.approx(upright.f_stops)
    assert found.focus.focus_w == pytest.approx(upright.focus.focus_w)
