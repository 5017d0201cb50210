"""The focal surface: exact at its points, continuous between them, local by β and strong by α (Lee et al. 2010, section 5.2)."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import SettingsError
from render.focus.surface import beyond_edge, focused_at, interpolate
from render.model.focal_surface import MAX_CONTROLS, Controls, FocalPlane, FocalSurface, HalfLens

PLANE = FocalPlane(0.25)
LEFT, RIGHT = (-0.2, 0.0), (0.2, 0.0)


def controls(places, w, weights=None, falloffs=None, exponent=3.0, log_extents=None):
    count = len(places)
    log_extents = np.zeros(count) if log_extents is None else np.asarray(log_extents, float)
    return Controls(
        np.asarray(places, float).reshape(count, 2),
        np.stack([np.asarray(w, float), log_extents], axis=-1),
        np.ones(count) if weights is None else np.asarray(weights, float),
        np.zeros(count) if falloffs is None else np.asarray(falloffs, float),
        exponent,
    )


def surface_w(plane, made, slopes, blend=1.0):
    return focused_at(FocalSurface(plane, made, blend), np.asarray(slopes, float))[0]


def test_a_plane_is_affine_in_the_slopes():
    w, pupil = focused_at(FocalSurface(FocalPlane(0.5, 0.1, -0.3)), np.array([[0.0, 0.0], [0.2, 0.1]]))
    assert w == pytest.approx([0.5, 0.5 + 0.02 - 0.03])
    assert np.array_equal(pupil, [1.0, 1.0])


@given(
    st.lists(st.tuples(st.floats(-0.4, 0.4), st.floats(-0.25, 0.25)), min_size=1, max_size=32, unique=True),
    st.floats(1.5, 6.0),
    st.randoms(use_true_random=False),
)
def test_every_point_has_its_own_value(places, exponent, random):
    apart = [p for i, p in enumerate(places) if all(math.dist(p, q) > 1e-3 for q in places[:i])]
    w = [random.uniform(0.05, 3.0) for _ in apart]
    weights = [random.uniform(0.1, 4.0) for _ in apart]
    falloffs = [random.choice([0.0, 0.3]) for _ in apart]
    logs = [random.uniform(-1, 1) for _ in apart]
    made = controls(apart, w, weights, falloffs, exponent, logs)
    got_w, got_pupil = focused_at(FocalSurface(PLANE, made), made.places)
    assert got_w == pytest.approx(w, rel=1e-3)
    assert got_pupil == pytest.approx(np.exp(-np.array(logs)), rel=1e-3)


def test_the_surface_never_leaves_the_range_of_its_values():
    rng = np.random.default_rng(3)
    made = controls(rng.uniform(-0.4, 0.4, (12, 2)), rng.uniform(0.2, 2, 12), rng.uniform(0, 2, 12))
    w = surface_w(PLANE, made, rng.uniform(-0.6, 0.6, (4000, 2)))
    assert w.min() >= made.values[:, 0].min() - 1e-12
    assert w.max() <= made.values[:, 0].max() + 1e-12


def steepest_step(exponent, count):
    """Largest step between neighbours on a line past two points, the line in ``count`` parts."""
    made = controls([LEFT, RIGHT, (0.05, 0.02)], [0.2, 2.0, 0.7], exponent=exponent)
    line = np.stack([np.linspace(-0.4, 0.4, count), np.full(count, 0.003)], axis=-1)
    return float(np.abs(np.diff(surface_w(PLANE, made, line))).max())


@pytest.mark.parametrize("exponent", [2.0, 3.0, 4.0])
def test_between_the_points_it_is_continuous(exponent):
    coarse, fine = steepest_step(exponent, 2001), steepest_step(exponent, 20001)
    assert fine == pytest.approx(coarse / 10, rel=0.1), "a step would not shrink with the distance"


def test_it_is_continuous_where_a_falloff_ends():
    made = controls([LEFT, RIGHT], [0.2, 2.0], falloffs=[0.1, 0.1])
    line = np.stack([np.linspace(-0.4, 0.4, 20001), np.zeros(20001)], axis=-1)
    w = surface_w(PLANE, made, line)
    assert np.abs(np.diff(w)).max() < 0.005
    assert w[0] == PLANE.w0, "beyond every falloff there is the plane"
    assert w[10000] == PLANE.w0


def share_of_left(slopes, weights=(1.0, 1.0), exponent=3.0):
    values, _ = interpolate(controls([LEFT, RIGHT], [1.0, 0.0], weights, exponent=exponent), np.asarray(slopes, float))
    return values[..., 0]


def test_the_more_a_point_weighs_the_larger_its_region_is():
    line = np.stack([np.linspace(-0.2, 0.2, 401), np.zeros(401)], axis=-1)
    shares = [share_of_left(line, (alpha, 1.0)) for alpha in (0.25, 1.0, 4.0, 16.0)]
    regions = [(share > 0.5).mean() for share in shares]
    assert regions == sorted(set(regions))
    # α/d^β is equal on both sides where d1/d2 = (α1/α2)^(1/β)
    ratio = 16 ** (1 / 3)
    assert regions[-1] == pytest.approx(ratio / (1 + ratio), abs=0.005)


def test_a_larger_exponent_narrows_the_change_between_regions():
    line = np.stack([np.linspace(-0.2, 0.2, 4001), np.zeros(4001)], axis=-1)
    widths = []
    for exponent in (1.0, 2.0, 3.0, 4.0, 12.0):
        share = share_of_left(line, exponent=exponent)
        widths.append(((share > 0.1) & (share < 0.9)).mean())
    assert widths == sorted(widths, reverse=True)
    # a share of 0.9 lies where (d2/d1)^β = 9
    assert widths[2] == pytest.approx((9 ** (1 / 3) - 1) / (9 ** (1 / 3) + 1), abs=0.002)
    assert widths[-1] < 0.1, "toward infinity the regions meet in a step"


def test_weights_matter_only_against_each_other():
    line = np.stack([np.linspace(-0.3, 0.3, 101), np.full(101, 0.01)], axis=-1)
    assert share_of_left(line, (2.0, 6.0)) == pytest.approx(share_of_left(line, (1.0, 3.0)), abs=1e-12)


def test_a_weight_of_zero_equals_absence():
    grid = np.random.default_rng(1).uniform(-0.4, 0.4, (500, 2))
    with_it = controls([LEFT, RIGHT, (0.0, 0.1)], [0.2, 2.0, 9.0], weights=[1, 1, 0])
    without = controls([LEFT, RIGHT], [0.2, 2.0])
    assert np.array_equal(surface_w(PLANE, with_it, grid), surface_w(PLANE, without, grid))


def test_the_blend_goes_from_the_plane_to_the_points():
    made = controls([LEFT, RIGHT], [0.2, 2.0], log_extents=[1.0, -1.0])
    for blend in (0.0, 0.25, 1.0):
        w, pupil = focused_at(FocalSurface(PLANE, made, blend), np.array([LEFT, RIGHT]))
        assert w == pytest.approx(PLANE.w0 + blend * (np.array([0.2, 2.0]) - PLANE.w0))
        assert pupil == pytest.approx(np.exp(-blend * np.array([1.0, -1.0])))


def test_a_half_lens_has_its_own_focus_beyond_its_edge():
    half = HalfLens((0.0, 1.0), offset=0.05, width=0.02, w=2.0)
    slopes = np.array([[0.3, 0.03], [0.3, 0.05], [-0.3, 0.07]])
    assert beyond_edge(half, slopes) == pytest.approx([0.0, 0.5, 1.0])
    w, _ = focused_at(FocalSurface(PLANE, halves=(half,)), slopes)
    assert w == pytest.approx([0.25, (0.25 + 2.0) / 2, 2.0])


def test_drawn_curvature_adds_to_whatever_is_focused():
    made = Controls(np.array([[0.0, 0.0]]), np.array([[-0.1]]), np.ones(1), np.zeros(1))
    w, _ = focused_at(FocalSurface(FocalPlane(0.25, 0.1), bends=made), np.array([[0.3, 0.1], [-0.3, 0.0]]))
    assert w == pytest.approx([0.25 + 0.03 - 0.1, 0.25 - 0.03 - 0.1])


def test_more_points_than_the_tracer_holds_are_refused():
    with pytest.raises(SettingsError, match=f"at most {MAX_CONTROLS} control points, got {MAX_CONTROLS + 1}"):
        controls(np.zeros((MAX_CONTROLS + 1, 2)), np.ones(MAX_CONTROLS + 1))


def test_more_half_lenses_than_the_tracer_holds_are_refused():
    half = HalfLens((1.0, 0.0), 0.1, 0.05, 0.5)
    assert len(FocalSurface(PLANE, halves=(half, half)).halves) == 2
    with pytest.raises(SettingsError, match="at most 2 half lenses, got 3"):
        FocalSurface(PLANE, halves=(half, half, half))
