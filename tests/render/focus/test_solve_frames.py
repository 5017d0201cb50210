"""Solving for focus over many frames at once: the same answers as frame by frame, and what must not change them."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from render.errors import SettingsError
from render.focus.overlap import overlap_shares
from render.focus.points import FocusTargets
from render.focus.solve import STATES, solve_distances, solve_focus
from render.model.lens_law import LensLaw

SLOPE_MM_M = 50.0 * 50.0 / 2.0 / 1000
seeds = st.integers(0, 2**31)


def random_targets(seed, frames=6, points=7, **changes):
    """Points of every kind, some of which do not count."""
    rng = np.random.default_rng(seed)
    shape = (frames, points)
    soft = rng.random(points) < 0.5
    columns = {
        "kinds": np.where(soft, "soft", "sharp").tolist(),
        "slopes": rng.uniform(-0.3, 0.3, (*shape, 2)),
        "weights": rng.uniform(0, 2, shape) * (rng.random(shape) < 0.9),
        "blurs_mm": np.where(soft & (rng.random(points) < 0.6), rng.uniform(0.01, 0.5, points), 0),
        "surface_offsets_m": rng.uniform(-0.2, 2, shape),
        "falloffs": rng.choice([0.0, 0.2], shape),
        "enabled": rng.random(shape) < 0.9,
        "in_frame": rng.random(shape) < 0.9,
        "visible": rng.choice([0.0, 0.3, 0.8, 1.0], shape),
        "frame_widths": 0.6,
    }
    depths_m = rng.uniform(-1, 20, shape)
    depths_m[rng.random(shape) < 0.05] = np.nan
    return FocusTargets.from_columns([f"p{i}" for i in range(points)], depths_m, **(columns | changes))


def solve(targets, **options):
    options = {"near_priority": 1.0, "occluded": "fade"} | options
    return solve_distances(targets, 5.0, SLOPE_MM_M, **options)


@given(seeds, st.sampled_from(["keep", "ignore", "fade"]), st.booleans())
def test_all_frames_at_once_are_solved_as_each_by_itself(seed, occluded, keep_outside):
    targets = random_targets(seed)
    options = {"near_priority": 1.5, "occluded": occluded, "keep_outside": keep_outside}
    together = solve(targets, **options)
    for frame in range(targets.frames):
        alone = solve(FocusTargets.at_one_time(targets.at(frame), 0.6), **options).at(0)
        at_once = together.at(frame)
        assert at_once.focus_distance_m == pytest.approx(alone.focus_distance_m, rel=1e-9)
        assert (at_once.states, at_once.source, at_once.reason) == (alone.states, alone.source, alone.reason)
        assert at_once.shares == pytest.approx(alone.shares, abs=1e-12)


@given(seeds)
def test_no_order_of_the_points_changes_the_focus(seed):
    targets = random_targets(seed)
    order = np.random.default_rng(seed).permutation(len(targets.names))
    columns = ("depths_m", "slopes", "weights", "blurs_mm", "surface_offsets_m", "falloffs")
    columns += ("extents", "enabled", "in_frame", "visible")
    shuffled = FocusTargets(
        tuple(targets.names[i] for i in order),
        tuple(targets.kinds[i] for i in order),
        *(getattr(targets, column)[:, order] for column in columns),
        targets.frame_widths,
        targets.field_shifts_w[:, order],
    )
    first, second = solve(targets), solve(shuffled)
    assert second.focus_w == pytest.approx(first.focus_w, rel=1e-9)
    assert second.shares == pytest.approx(first.shares[:, order], abs=1e-12)


@given(seeds)
def test_a_point_of_no_weight_is_as_good_as_absent(seed):
    targets = random_targets(seed)
    weights = targets.weights.copy()
    weights[:, 3] = 0.0
    names = [name for name in targets.names if name != "p3"]
    others = [i for i in range(len(targets.names)) if i != 3]
    without = random_targets(seed, weights=weights)
    absent = FocusTargets.from_columns(
        names,
        targets.depths_m[:, others],
        kinds=[targets.kinds[i] for i in others],
        slopes=targets.slopes[:, others],
        weights=weights[:, others],
        blurs_mm=targets.blurs_mm[:, others],
        surface_offsets_m=targets.surface_offsets_m[:, others],
        falloffs=targets.falloffs[:, others],
        enabled=targets.enabled[:, others],
        in_frame=targets.in_frame[:, others],
        visible=targets.visible[:, others],
        frame_widths=0.6,
    )
    assert solve(without).focus_w == pytest.approx(solve(absent).focus_w, rel=1e-9)


def seen_by(world_from_camera, places):
    """Depths and slopes of world places ``(n, 3)`` before a camera that looks along -Z."""
    local = (places - world_from_camera[:3, 3]) @ world_from_camera[:3, :3]
    depths = -local[:, 2]
    return depths[None], (local[:, :2] / depths[:, None])[None]


def random_pose(rng):
    axes, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    pose = np.eye(4)
    pose[:3, :3] = axes * np.sign(np.linalg.det(axes))
    pose[:3, 3] = rng.uniform(-100, 100, 3)
    return pose


@given(seeds)
def test_moving_scene_and_camera_together_changes_nothing(seed):
    rng = np.random.default_rng(seed)
    camera, move = random_pose(rng), random_pose(rng)
    local = np.c_[rng.uniform(-2, 2, (6, 2)), -rng.uniform(0.5, 30, 6)]
    places = local @ camera[:3, :3].T + camera[:3, 3]
    moved = places @ move[:3, :3].T + move[:3, 3]
    found = []
    for pose, scene in ((camera, places), (move @ camera, moved)):
        depths_m, slopes = seen_by(pose, scene)
        kinds = ["sharp"] * 3 + ["soft"] * 3
        targets = FocusTargets.from_columns(
            "abcdef", depths_m, kinds=kinds, slopes=slopes, blurs_mm=[0, 0, 0, 0.1, 0.2, 0.05]
        )
        found.append(solve(targets).focus_distance_m[0])
    assert found[1] == pytest.approx(found[0], rel=1e-7)


@given(seeds, st.floats(0.01, 100))
def test_the_focus_scales_with_the_scene(seed, scale):
    """A world and its lens twice as large, on film that wants the same circles, focus twice as far."""
    targets = random_targets(seed)
    larger = random_targets(
        seed, surface_offsets_m=targets.surface_offsets_m * scale, slopes=targets.slopes, weights=targets.weights
    )
    larger = FocusTargets(**(vars(larger) | {"depths_m": targets.depths_m * scale}))
    first = solve_distances(targets, 5.0, SLOPE_MM_M, near_priority=1.0)
    second = solve_distances(larger, 5.0 * scale, SLOPE_MM_M * scale, near_priority=1.0)
    assert second.focus_distance_m == pytest.approx(first.focus_distance_m * scale, rel=1e-9)


def test_hidden_points_are_kept_left_out_or_faded():
    targets = FocusTargets.from_columns(["seen", "veiled"], [2.0, 4.0], visible=[1.0, 0.25])
    found = {how: solve_distances(targets, occluded=how) for how in ("keep", "ignore", "fade")}
    assert found["keep"].focus_w[0] == pytest.approx(0.375)
    assert found["ignore"].focus_w[0] == pytest.approx(0.5)
    assert found["fade"].focus_w[0] == pytest.approx((0.5 + 0.25 * 0.25) / 1.25)
    assert found["ignore"].states[:, 1].tolist() == ["hidden"]
    gone = FocusTargets.from_columns(["veiled"], [4.0], visible=0.0)
    assert solve_distances(gone, 7.0, occluded="fade").at(0).states == ("hidden",)
    assert "hidden" in STATES


def test_a_soft_point_counts_beside_a_sharp_one_and_not_on_top():
    def focus(offset):
        slopes = [[[0.0, 0.0], [offset, 0.0]]]
        targets = FocusTargets.from_columns("ab", [2.0, 4.0], kinds=["sharp", "soft"], blurs_mm=[0, 0.5], slopes=slopes)
        return solve_distances(targets, 2.0, SLOPE_MM_M).focus_w[0]

    places = np.linspace(0, 0.08, 801)
    found = np.array([focus(place) for place in places])
    assert found[0] == pytest.approx(0.5)
    free = FocusTargets.from_columns("ab", [2.0, 4.0], kinds=["sharp", "soft"], blurs_mm=[0, 0.5])
    assert found[-1] == solve_distances(free, 2.0, SLOPE_MM_M).focus_w[0]
    assert (np.diff(found) >= 0).all()
    assert np.diff(found).max() < 0.01 * (found[-1] - found[0])


@given(seeds)
@settings(max_examples=30)
def test_what_soft_points_keep_is_what_the_formula_says(seed):
    """Against the formula of the module's head, one pair at a time."""
    rng = np.random.default_rng(seed)
    n, k = 3, 40
    slopes = rng.uniform(-0.2, 0.2, (n, k, 2))
    slopes[rng.random((n, k)) < 0.1] = np.nan
    slopes[0, 0] = (1e12, 0.0)
    reaches, weights = rng.uniform(0.01, 0.3, (n, k)), rng.uniform(0.1, 2, (n, k))
    soft = rng.random(k) < 0.5
    sharp = ~soft & (rng.random((n, k)) < 0.8)
    kept = overlap_shares(slopes, reaches, weights, soft, sharp)
    for frame in range(n):
        for i in range(k):
            share = 1.0
            for j in np.flatnonzero(sharp[frame]) if soft[i] else []:
                d = math.dist(slopes[frame, i], slopes[frame, j]) / reaches[frame, i]
                if d < 1:
                    share *= 1 - min(1, weights[frame, j] / weights[frame, i]) * (1 - d**2) ** 2
            assert kept[frame, i] == pytest.approx(share, abs=1e-12)


def energies(targets, law, x):
    """Weighted squared error of circles of confusion at each x, in mm², as the head of the module says it."""
    x = np.asarray(x)[:, None]
    slope = law.coc_slope_mm_m(x[:, 0])[:, None]
    circles = np.where(targets.is_blurred, targets.blurs_mm, 0)[0]
    return np.sum(targets.weights[0] * (slope * np.abs(targets.aims_w[0] - x) - circles) ** 2, axis=1)


def curved_law(near_w=4.0):
    """A law that is not straight, as of a lens that focuses by moving glass inside."""
    w = np.linspace(0, near_w, 33)
    slopes = 1.25 / (1 - 0.1 * w + 0.008 * w**2)
    return LensLaw(slopes[None], 12 + 0 * slopes[None], *np.array([[1.0], [near_w], [0.0], [0.0]]))


@pytest.mark.parametrize("law", [LensLaw.thin(80.0, 1.0, breathing=True, near_w=4.0), curved_law()])
@given(seed=seeds)
@settings(max_examples=40)
def test_no_other_focus_is_better_through_a_lens_with_its_own_law(law, seed):
    rng = np.random.default_rng(seed)
    kinds = rng.choice(["sharp", "soft"], 5).tolist()
    targets = FocusTargets.from_columns(
        "abcde",
        rng.uniform(0.2, 10, (1, 5)),
        kinds=kinds,
        blurs_mm=rng.uniform(0.1, 3, 5),
        weights=rng.uniform(0.1, 2, 5),
    )
    found = solve_distances(targets, 5.0, law=law)
    assert found.focus_w[0] <= 4.0 * (1 + 1e-12)
    best = energies(targets, law, np.linspace(0, 4, 2001)).min()
    assert energies(targets, law, found.focus_w)[0] <= best * (1 + 1e-6) + 1e-12


def test_where_the_lens_ends_the_focus_ends_and_says_so():
    law = LensLaw.thin(50.0, 2.0, breathing=True, near_w=1 / 0.45)
    near = solve_focus(FocusTargets.from_columns(["fly"], [0.2]).at(0), 5.0, law=law)
    assert near.focus_distance_m == pytest.approx(0.45)
    assert near.limit == "close_focus"
    assert near.reason == "focused by fly, but the lens focuses no nearer than 0.45 m"
    soft = FocusTargets.from_columns(["a", "b"], [4.0, 5.0], kinds="soft", blurs_mm=[0.9, 0.9], weights=[1, 1])
    far = solve_distances(soft, math.inf, law=LensLaw.thin(50.0, 2.0, near_w=0.26)).at(0)
    assert far.limit == "infinity"
    assert "no farther than infinity" in far.reason
    assert solve_focus(FocusTargets.from_columns(["hero"], [0.45]).at(0), 5.0, law=law).limit == ""


@pytest.mark.parametrize(
    ("column", "words"),
    [
        ("weights", "weight of focus point 'b'"),
        ("blurs_mm", "blur in mm of focus point 'b'"),
        ("falloffs", "falloff in frame widths of focus point 'b'"),
        ("extents", "extent of focus point 'b'"),
        ("visible", "visible share of focus point 'b'"),
    ],
)
@pytest.mark.parametrize("bad", [math.nan, -1.0])
def test_impossible_numbers_name_the_point(column, words, bad):
    with pytest.raises(SettingsError, match=words) as raised:
        FocusTargets.from_columns("ab", [[1.0, 2.0], [1.0, 2.0]], **{column: [[1.0, 1.0], [1.0, bad]]})
    assert raised.value.code == "bad_focus_point"


def test_columns_of_another_size_are_refused():
    targets = random_targets(1)
    with pytest.raises(SettingsError, match="weights"):
        FocusTargets(**(vars(targets) | {"weights": targets.weights[:1]}))
    with pytest.raises(SettingsError, match="camera distances"):
        solve_distances(targets, [1.0, 2.0], SLOPE_MM_M)
    with pytest.raises(SettingsError, match="focus law of 2 frames"):
        solve_distances(targets, 1.0, law=LensLaw.thin([50.0, 60.0], 2.0))
