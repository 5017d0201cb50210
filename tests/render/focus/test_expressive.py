"""From focus points to a focal surface: what each wants, and that none of them pops when it comes or goes."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import SettingsError
from render.focus.drawn import Frame, bends, half_lenses
from render.focus.expressive import (
    SurfacePoints,
    focal_controls,
    soft_sides,
    target_w,
)
from render.focus.overlap import OVERLAP_FRAME_WIDTHS
from render.focus.surface import beyond_edge, focused_at
from render.model.camera import Camera
from render.model.focal_surface import FocalPlane, FocalSurface

WIDTH = 0.72  # 36 mm before 50 mm
SLOPE_MM_M = 50 * 50 / 2 / 1000  # 50 mm at f/2
UPRIGHT = FocalPlane(0.25)
TILTED = FocalPlane(0.25, 0.1, -0.4)
GRID = np.stack(np.meshgrid(np.linspace(-0.36, 0.36, 97), np.linspace(-0.2, 0.2, 55)), axis=-1)


def points(slopes, depths_m, **columns):
    count = len(depths_m)
    defaults = {
        "weights": np.ones(count),
        "soft": np.zeros(count, bool),
        "blurs_mm": np.zeros(count),
        "surface_offsets_m": np.zeros(count),
        "falloffs": np.zeros(count),
        "extents": np.ones(count),
        "fades": np.ones(count),
        "field_shifts_w": np.zeros(count),
    }
    given_columns = {name: np.asarray(column) for name, column in columns.items()}
    names = [f"point{i}" for i in range(count)]
    slopes, depths_m = np.asarray(slopes, float).reshape(count, 2), np.asarray(depths_m, float)
    return SurfacePoints(names, slopes, depths_m, **(defaults | given_columns))


def surface(made, plane=UPRIGHT, **options):
    settings = {"coc_slope_mm_m": SLOPE_MM_M, "frame_width": WIDTH} | options
    return FocalSurface(plane, focal_controls(made, plane=plane, **settings))


def w_at(made, slopes=GRID, plane=UPRIGHT, **options):
    return focused_at(surface(made, plane, **options), np.asarray(slopes, float))[0]


def random_points(count, seed, **columns):
    rng = np.random.default_rng(seed)
    slopes = np.stack([rng.uniform(-0.35, 0.35, count), rng.uniform(-0.2, 0.2, count)], axis=-1)
    return points(slopes, 1 / rng.uniform(0.1, 1.5, count), weights=rng.uniform(0.3, 3, count), **columns)


@given(st.integers(1, 32), st.integers(0, 1000), st.floats(2, 4), st.sampled_from([0.0, 1.0]))
def test_every_point_has_the_focus_it_needs(count, seed, exponent, near_priority):
    made = random_points(count, seed, extents=np.random.default_rng(seed).uniform(0.3, 4, count))
    shown = surface(made, TILTED, exponent=exponent, near_priority=near_priority)
    w, pupil = focused_at(shown, made.slopes)
    assert w == pytest.approx(1 / made.depths_m, rel=1e-3)
    assert pupil == pytest.approx(1 / made.extents, rel=1e-3)


def test_a_soft_point_gets_the_circle_of_confusion_that_it_asks_for():
    blurs, extents = np.array([0.1, 0.3, 0.05]), np.array([1.0, 2.0, 0.5])
    made = points([[-0.2, 0], [0.0, 0.1], [0.2, 0]], [1.5, 6.0, 4.1], soft=[True] * 3, blurs_mm=blurs, extents=extents)
    w, pupil = focused_at(surface(made), made.slopes)
    assert SLOPE_MM_M * pupil * np.abs(w - 1 / made.depths_m) == pytest.approx(blurs, rel=1e-3)
    assert np.array_equal(np.sign(w - 1 / made.depths_m), [-1, 1, 1]), "toward where the lens is focused"


def test_a_soft_point_by_offset_has_the_focus_that_far_behind_it():
    made = points([[-0.2, 0], [0.2, 0]], [2.0, 5.0], soft=[True, True], surface_offsets_m=[0.5, -1.0])
    assert 1 / w_at(made, made.slopes) == pytest.approx([2.5, 4.0], rel=1e-3)


def test_the_focus_is_before_a_soft_point_instead_of_beyond_infinity():
    made = points([[0.0, 0.0]], [8.0], soft=[True], blurs_mm=[SLOPE_MM_M * 0.2])
    assert target_w(made, FocalPlane(0.05), SLOPE_MM_M) == pytest.approx([0.125 + 0.2])


def test_a_soft_point_keeps_its_side_through_a_shot():
    depths_m = np.array([[3.0], [3.9], [4.1], [6.0]])  # it walks through the plane of focus at 4 m
    off = np.full((4, 1), 0.05)
    side = soft_sides(1 / depths_m, np.full((4, 1), 0.25), off)
    frames = [
        target_w(points([[0, 0]], d, soft=[True], blurs_mm=[0.05 * SLOPE_MM_M]), UPRIGHT, SLOPE_MM_M, side)
        for d in depths_m
    ]
    assert np.ravel(frames) == pytest.approx(1 / depths_m.ravel() + side * 0.05)


@pytest.mark.parametrize(
    ("depth_m", "columns", "slope_mm_m"),
    [
        (math.nan, {}, SLOPE_MM_M),
        (-2.0, {}, SLOPE_MM_M),
        (2.0, {"weights": [0.0]}, SLOPE_MM_M),
        (2.0, {"fades": [0.0]}, SLOPE_MM_M),
        (2.0, {"soft": [True], "surface_offsets_m": [-3.0]}, SLOPE_MM_M),
        (2.0, {"soft": [True], "blurs_mm": [0.1]}, 0.0),  # a pinhole makes nothing soft
    ],
)
def test_what_cannot_count_leaves_the_plane(depth_m, columns, slope_mm_m):
    made = points([[0.0, 0.0]], [depth_m], **columns)
    assert focal_controls(made, plane=TILTED, coc_slope_mm_m=slope_mm_m, frame_width=WIDTH) is None


def test_no_points_leave_the_plane():
    assert focal_controls(points([], []), plane=TILTED, coc_slope_mm_m=SLOPE_MM_M, frame_width=WIDTH) is None


def test_nearer_points_count_more_on_request():
    made = points([[-0.2, 0], [0.2, 0]], [1.0, 4.0])
    middle = np.array([0.0, 0.0])
    even = w_at(made, middle)
    near = w_at(made, middle, near_priority=2.0)
    assert even == pytest.approx((1 + 0.25) / 2)
    assert near == pytest.approx((16 * 1 + 0.25) / 17)


def test_soft_points_near_sharp_ones_lose_influence_with_distance():
    overlap = OVERLAP_FRAME_WIDTHS * WIDTH
    slopes = np.array([[0, 0], [0, 0], [overlap / 2, 0], [overlap, 0], [math.nan, math.nan]])
    soft = np.array([False, True, True, True, False])
    made = points(slopes[:2], [2.0, 3.0], soft=soft[:2], blurs_mm=[0, 0.3])
    assert w_at(made) == pytest.approx(0.5), "right on the sharp point it has none at all"
    shares = []
    for at in (2, 3):
        pair = points(slopes[[0, at]], [2.0, 3.0], soft=soft[[0, at]], blurs_mm=[0, 0.3])
        controls = focal_controls(pair, plane=UPRIGHT, coc_slope_mm_m=SLOPE_MM_M, frame_width=WIDTH)
        shares.append(controls.weights[1] / controls.weights[0])
    assert 0 < shares[0] < shares[1] == pytest.approx(1), "and away from it, it gains it back"


def steps(made, fades, plane, **options):
    """``(len(fades) - 1,)`` largest change over the picture from one fade of the first point to the next."""
    shown = []
    for fade in fades:
        all_fades = made.fades.copy()
        all_fades[0] = fade
        shown.append(w_at(replace(made, fades=all_fades), plane=plane, **options))
    return np.abs(np.diff(np.stack(shown), axis=0)).max(axis=(1, 2))


@pytest.mark.parametrize("plane", [UPRIGHT, TILTED], ids=["upright", "tilted"])
@pytest.mark.parametrize("falloff", [0.0, 0.3])
@pytest.mark.parametrize("count", [1, 2, 12])
@pytest.mark.parametrize("exponent", [2.0, 4.0])
def test_the_surface_fades_with_a_point(plane, falloff, count, exponent):
    """The bound: in a frame in which a point fades by Δg, no pixel's w changes by more than 3.5·Δg of the surface's range."""
    for seed in range(4):
        made = random_points(count, seed, falloffs=np.full(count, falloff))
        # a sample of the picture is at the point itself, where a spike would stand
        made = replace(made, slopes=np.concatenate([GRID[20, 30][None], made.slopes[1:]]))
        values = np.append(1 / made.depths_m, [0.25 - 0.12, 0.25 + 0.12])
        bound = 3.5 * np.ptp(values) / 24
        changes = steps(made, np.linspace(0, 1, 25), plane, exponent=exponent)
        assert changes.max() < bound
        gone = steps(made, [0.0, 1e-4], plane, exponent=exponent)
        assert gone.max() < bound / 400, "it leaves without a step"


def test_points_that_fade_together_leave_together_without_a_step():
    """As those on one subject do when it leaves the picture."""
    made = points([[0.1, 0.0], [0.101, 0.0], [0.1, 0.001]], [1.0, 1.01, 0.99])
    shown = [w_at(replace(made, fades=np.full(3, fade))) for fade in np.linspace(0, 1, 25)]
    changes = np.abs(np.diff(np.stack(shown), axis=0)).max(axis=(1, 2))
    assert changes.max() < 4 * 0.75 / 24
    assert np.array_equal(shown[0], np.full(GRID.shape[:2], 0.25))


def test_points_that_overtake_each_other_in_fading_make_no_step():
    made = random_points(6, 5)
    fades = np.array([0.5, 0.5, 0.8, 1.0, 0.5, 0.3])
    for lower, upper in ((0.5 - 1e-5, 0.5 + 1e-5), (0.8 - 1e-5, 0.8 + 1e-5), (1 - 2e-5, 1.0)):
        change = steps(replace(made, fades=fades), [lower, upper], TILTED)
        assert change.max() < 8e-5 * 1.5


def test_a_weight_that_is_keyed_down_to_nothing_makes_no_step():
    made = random_points(5, 11)
    shown = []
    for weight in (1e-4, 1e-5, 0.0):
        weights = made.weights.copy()
        weights[0] = weight
        shown.append(w_at(replace(made, weights=weights), np.concatenate([GRID.reshape(-1, 2), made.slopes])))
    assert np.abs(shown[0] - shown[2]).max() < 4e-3
    assert np.abs(shown[1] - shown[2]).max() < 4e-4


@given(st.integers(2, 16), st.integers(0, 100), st.randoms(use_true_random=False))
def test_the_order_of_the_points_changes_nothing(count, seed, random):
    rng = np.random.default_rng(seed)
    made = random_points(count, seed, fades=rng.uniform(0, 1, count), soft=rng.random(count) < 0.3)
    order = list(range(count))
    random.shuffle(order)
    turned = SurfacePoints(*(np.asarray(column)[order] for column in vars(made).values()))
    assert w_at(turned, plane=TILTED) == pytest.approx(w_at(made, plane=TILTED), abs=1e-9)


def test_weights_of_zero_equal_absence():
    made = random_points(4, 2)
    more = points(np.concatenate([made.slopes, [[0.1, 0.1]]]), [*made.depths_m, 0.3], weights=[*made.weights, 0.0])
    assert np.array_equal(w_at(more), w_at(made))


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (
            {"weights": [1.0, math.nan]},
            "weight of focus point 'point1' must be a finite number of at least 0, but it is nan",
        ),
        ({"weights": [-1.0, 1.0]}, "weight of focus point 'point0'"),
        ({"extents": [1.0, 0.0]}, "extent of focus point 'point1'"),
        ({"falloffs": [math.inf, 0.0]}, "falloff in frame widths of focus point 'point0'"),
        ({"blurs_mm": [0.0]}, "as long"),
    ],
)
def test_impossible_numbers_name_the_point(columns, message):
    with pytest.raises(SettingsError, match=message):
        points([[0, 0], [0.1, 0]], [2.0, 3.0], **columns)


def film_distance_m(w):
    return 1 / (20 - w)  # 1/f of 50 mm is 20/m


def test_an_offset_of_the_film_moves_the_focus_as_the_thin_lens_says():
    places, offsets_mm = np.array([[0.2, 0.1], [-0.3, 0.0]]), np.array([0.2, -0.1])
    made = bends(places, offsets_mm, surface=FocalSurface(TILTED), focal_length_mm=50.0)
    before, _ = focused_at(FocalSurface(TILTED), places)
    after, _ = focused_at(FocalSurface(TILTED, bends=made), places)
    assert film_distance_m(before) - film_distance_m(after) == pytest.approx(offsets_mm / 1000, rel=1e-9)
    assert after[0] < before[0], "film nearer to the lens is focused farther away"


def test_film_that_is_moved_into_the_lens_is_refused():
    with pytest.raises(SettingsError, match=r"leave it behind the lens of 50 mm, but one is 60 mm"):
        bends(np.zeros((2, 2)), np.array([1.0, 60.0]), surface=FocalSurface(UPRIGHT), focal_length_mm=50.0)
    assert bends(np.empty((0, 2)), np.empty(0), surface=FocalSurface(UPRIGHT), focal_length_mm=50.0) is None


def test_places_of_the_frame_are_slopes_through_the_gate():
    camera = Camera(np.eye(4), 50.0, 36.0, 20.0, horizontal_offset_mm=5.0, vertical_offset_mm=-2.0)
    slopes = Frame.from_camera(camera).slopes(np.array([[0.5, 0.5], [0.0, 0.0], [1.0, 1.0]]))
    assert slopes == pytest.approx(np.array([[5, -2], [5 - 18, -2 + 10], [5 + 18, -2 - 10]]) / 50)
    assert Frame.from_camera(camera, stretch=2.0).width == pytest.approx(0.36)


def test_half_lenses_lie_where_the_camera_says():
    camera = Camera(np.eye(4), 50.0, 36.0, 20.0)
    first, second = half_lenses([(0.5, 0.1, 2.0), (0.8, 0.0, 0.0)], 0.0, Frame.from_camera(camera))
    assert beyond_edge(first, np.array([[0.09, 0.2], [0.18, 0.0], [0.27, -0.2]])) == pytest.approx([0, 0.5, 1])
    assert (first.w, second.w) == (0.5, 0.0)
    assert second.offset == pytest.approx(0.8 * 0.36)
    (upper,) = half_lenses([(0.0, 0.1, 2.0)], math.pi / 2, Frame.from_camera(camera))
    assert beyond_edge(upper, np.array([[0.3, 0.1], [-0.3, -0.1]])) == pytest.approx([1, 0])


def test_a_half_lenss_edge_is_measured_from_a_shifted_frames_middle():
    camera = Camera(np.eye(4), 50.0, 36.0, 20.0, horizontal_offset_mm=5.0)
    (half,) = half_lenses([(0.0, 0.1, 2.0)], 0.0, Frame.from_camera(camera))
    assert half.offset == pytest.approx(0.1)
    with pytest.raises(SettingsError, match="a width of 0 or more"):
        half_lenses([(0.0, -0.1, 2.0)], 0.0, Frame.from_camera(camera))
