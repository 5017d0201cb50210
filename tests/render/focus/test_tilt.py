"""Tilted planes of focus: through the points that ask for them, and from a lens that bends no rule of optics."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from render.errors import SettingsError
from render.focus.points import FocusTargets
from render.focus.solve import solve_distances
from render.focus.tilt import (
    fit_planes,
    fit_targets,
    hinge_m,
    lens_axis,
    limit_plane,
    limit_planes,
    plane_of,
    plane_through,
    tilt_and_swing,
)
from render.model.focal_surface import FocalPlane

FOCAL_MM, STOP = 90.0, 2.8
FILM_MM, WIDTH_PX = 36.0, 1920
seeds = st.integers(0, 2**31)


def w_on(plane, slopes):
    return plane.w0 + slopes @ [plane.slope_x, plane.slope_y]


def random_plane(seed, most_degrees=12, focal_mm=FOCAL_MM):
    rng = np.random.default_rng(seed)
    steepness = math.sin(math.radians(rng.uniform(0, most_degrees))) / (focal_mm / 1000)
    direction = rng.uniform(0, 2 * math.pi)
    return FocalPlane(1 / rng.uniform(1, 8), steepness * math.cos(direction), steepness * math.sin(direction))


def points_on(plane, seed, count=6):
    """Slopes and w of points of a plane that lie in the picture, before the camera."""
    rng = np.random.default_rng(seed)
    slopes = rng.uniform(-1, 1, (400, 2)) * [0.2, 0.11]
    return slopes[w_on(plane, slopes) > 0.02][:count]


def circle_on_film_px(axis, film_m, point):
    """Traces rays from a point through the rim of a thin lens that is turned along an axis, to an upright film.

    The lens images by its own thin lens equation along its own axis; nothing here knows of planes of focus.
    """
    focal_m = FOCAL_MM / 1000
    across = np.cross(axis, [0.3, 1.0, 0.2])
    across /= np.linalg.norm(across)
    up = np.cross(axis, across)
    turn = np.linspace(0, 2 * math.pi, 24, endpoint=False)
    rim = focal_m / STOP / 2 * (np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * up)
    depth = point @ axis
    image = -point * (1 / (1 / focal_m - 1 / depth)) / depth  # straight on through the centre
    rays = image - rim
    hits = rim + rays * ((-film_m - rim[:, 2]) / rays[:, 2])[:, None]
    spread_m = np.linalg.norm(hits - hits.mean(axis=0), axis=1).max() * 2
    return spread_m * 1000 / FILM_MM * WIDTH_PX


@pytest.mark.parametrize("seed", range(200))
def test_a_lens_tilted_as_solved_shows_the_plane_sharp(seed):
    asked = random_plane(seed)
    slopes = points_on(asked, seed)
    fit = plane_through(slopes, w_on(asked, slopes))
    assert fit.rank == 3
    plane, was_limited = limit_plane(fit.plane, FOCAL_MM, math.radians(15), slopes, w_on(asked, slopes))
    assert not was_limited
    tilt, swing = tilt_and_swing(plane, FOCAL_MM)
    turned = turn_about_x(tilt) @ turn_about_y(swing) @ [0, 0, -1]  # camera space: looks along -Z
    axis = turned * [1, 1, -1]
    assert axis == pytest.approx(lens_axis(plane, FOCAL_MM), abs=1e-12)
    film_m = 1 / (axis[2] / (FOCAL_MM / 1000) - plane.w0)
    for slope, w in zip(slopes, w_on(asked, slopes), strict=True):
        point = np.array([*slope, 1.0]) / w
        assert circle_on_film_px(axis, film_m, point) < 0.1
        assert circle_on_film_px(axis, film_m, point * 3) > 1  # the trace can tell


def turn_about_x(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def turn_about_y(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


@given(seeds)
def test_the_hinge_line_lies_where_merklinger_has_it(seed):
    """Refocusing swings the plane about the line in which it meets the plane of the pupil, f / sin(angle) away."""
    plane = random_plane(seed)
    assume(not plane.is_upright)
    tilt, swing = tilt_and_swing(plane, FOCAL_MM)
    angle = math.acos(np.clip(lens_axis(plane, FOCAL_MM)[2], -1, 1))
    assume(angle > 1e-4)
    assert hinge_m(plane) == pytest.approx(FOCAL_MM / 1000 / math.sin(angle), rel=1e-6)
    steep = np.array([plane.slope_x, plane.slope_y])
    foot = steep / (steep @ steep)  # (X, Y) on the plane at z = 0: 1 = w0·z + g·(X, Y)
    assert np.hypot(*foot) == pytest.approx(hinge_m(plane), rel=1e-9)
    for distance_m in (0.7, 3.0, math.inf):
        refocused = plane_of(tilt, swing, distance_m, FOCAL_MM)
        assert foot @ [refocused.slope_x, refocused.slope_y] == pytest.approx(1)
        assert refocused.w0 == pytest.approx(1 / distance_m)


@given(seeds)
def test_angles_by_hand_and_the_plane_are_one_and_the_same(seed):
    plane = random_plane(seed, 80)
    tilt, swing = tilt_and_swing(plane, FOCAL_MM)
    again = plane_of(tilt, swing, 1 / plane.w0, FOCAL_MM)
    assert [again.w0, again.slope_x, again.slope_y] == pytest.approx([plane.w0, plane.slope_x, plane.slope_y], abs=1e-9)


def test_a_lens_tilted_down_lays_the_plane_over_the_ground():
    plane = plane_of(math.radians(-3), 0.0, math.inf, 50.0)
    assert plane.slope_y < 0
    assert hinge_m(plane) == pytest.approx(0.05 / math.sin(math.radians(3)))  # so far below the lens
    left = plane_of(0.0, math.radians(5), 3.0, 50.0)
    assert (
        w_on(left, np.array([-0.2, 0.0])) > 1 / 3
    )  # a lens that looks left focuses nearer there, as one that looks down


@given(seeds, st.floats(0, 0.05))
def test_no_other_plane_leaves_less_blur(seed, noise):
    rng = np.random.default_rng(seed)
    slopes, weights = rng.uniform(-0.3, 0.3, (8, 2)), rng.uniform(0.1, 2, 8)
    w = w_on(random_plane(seed), slopes) + rng.normal(0, noise, 8)
    assume(np.linalg.svd(slopes - slopes.mean(axis=0))[1].min() > 0.02)
    fit = plane_through(slopes, w, weights)

    def blur(row):
        return np.average((w - row[0] - slopes @ row[1:]) ** 2, weights=weights)

    found = np.array([fit.plane.w0, fit.plane.slope_x, fit.plane.slope_y])
    assert fit.residual == pytest.approx(math.sqrt(blur(found)), abs=1e-12)
    for step in rng.normal(0, 0.02, (20, 3)):
        assert blur(found) <= blur(found + step) + 1e-9


@given(seeds)
def test_order_and_points_of_no_weight_do_not_matter(seed):
    rng = np.random.default_rng(seed)
    slopes, w, weights = rng.uniform(-0.3, 0.3, (6, 2)), rng.uniform(0.1, 1, 6), rng.uniform(0.1, 2, 6)
    order = rng.permutation(6)
    first = plane_through(slopes, w, weights).plane
    second = plane_through(slopes[order], w[order], weights[order]).plane
    odd = plane_through([*slopes, [np.nan, 1.0]], [*w, np.nan], [*weights, 0.0]).plane
    for other in (second, odd):
        assert [other.w0, other.slope_x, other.slope_y] == pytest.approx(
            [first.w0, first.slope_x, first.slope_y], rel=1e-6, abs=1e-9
        )


def test_one_point_gives_an_upright_plane_and_says_so():
    fit = plane_through([[0.1, -0.05]], [0.4])
    assert (fit.rank, fit.plane, fit.residual) == (1, FocalPlane(0.4), 0)
    assert "square to the view axis" in fit.reason
    assert plane_through([[0.1, 0.1]] * 3, [0.2, 0.4, 0.6]).plane.w0 == pytest.approx(0.4)


@pytest.mark.parametrize("count", [2, 5])
def test_points_in_line_give_the_plane_of_least_tilt_through_them(count):
    along = np.array([0.6, 0.8])
    t = np.linspace(-0.1, 0.15, count)
    w = 0.5 + 0.8 * t
    fit = plane_through(t[:, None] * along + [0.02, 0.01], w)
    assert fit.rank == 2
    assert "least tilt" in fit.reason
    assert fit.residual < 1e-9
    assert [fit.plane.slope_x, fit.plane.slope_y] == pytest.approx(0.8 * along)  # none across the line


def test_points_that_come_into_line_do_not_make_the_plane_jump():
    """Three points whose middle one sinks onto the line of the others, which it does not fit: the tilt passes on smoothly."""
    heights = np.geomspace(1e-1, 1e-9, 4000)
    slopes = np.zeros((len(heights), 3, 2))
    slopes[:, :, 0] = [-0.1, 0.0, 0.1]
    slopes[:, 1, 1] = heights
    fits = fit_planes(slopes, np.broadcast_to([0.4, 0.4001, 0.4], (len(heights), 3)))
    planes, _ = limit_planes(fits.planes, FOCAL_MM, math.radians(15), slopes, np.full(slopes.shape[:2], 0.4))
    tilts = planes[:, 2]
    assert fits.ranks[0] == 3
    assert fits.ranks[-1] == 2
    assert abs(tilts[-1]) < 1e-4
    assert np.abs(np.diff(tilts)).max() < 0.02 * np.abs(tilts).max()


@given(seeds, st.floats(0, 30))
def test_limits_hold_and_no_plane_within_them_is_better(seed, degrees):
    rng = np.random.default_rng(seed)
    slopes, w = rng.uniform(-0.3, 0.3, (5, 2)), rng.uniform(0.05, 2, 5)
    fit = plane_through(slopes, w)
    plane, changed = limit_plane(fit.plane, FOCAL_MM, math.radians(degrees), slopes, w)
    steepest = math.sin(math.radians(degrees)) / (FOCAL_MM / 1000)
    steepness = math.hypot(plane.slope_x, plane.slope_y)
    assert steepness <= steepest * (1 + 1e-9)
    assert plane.w0 >= 0
    if not changed:
        assert plane == fit.plane
        return
    direction = np.array([fit.plane.slope_x, fit.plane.slope_y])
    along = slopes @ direction / np.hypot(*direction)
    found = np.mean((w - plane.w0 - steepness * along) ** 2)
    for tilt in np.linspace(0, steepest, 21):
        for w0 in np.linspace(0, 3, 61):
            assert found <= np.mean((w - w0 - tilt * along) ** 2) + 1e-9


def test_a_plane_along_the_view_axis_is_tilted_up_to_the_lenss_limit():
    slopes = np.array([[0.0, -1e-3], [0.0, 1e-3], [0.1, 0.0]])
    w = np.array([0.2, 2.0, 1.1])  # near and far points almost behind each other
    fit = plane_through(slopes, w)
    plane, changed = limit_plane(fit.plane, FOCAL_MM, math.radians(8), slopes, w)
    assert changed
    tilt, swing = tilt_and_swing(plane, FOCAL_MM)
    assert math.acos(math.cos(tilt) * math.cos(swing)) == pytest.approx(math.radians(8))
    assert plane.w0 == pytest.approx(w.mean() - (slopes @ [plane.slope_x, plane.slope_y]).mean())


def test_level_ground_before_a_level_camera_needs_no_limit():
    """1.6 m below the lens: the plane is parallel to the axis, focused at infinity, and a lens tilted by two degrees gives it."""
    slopes = np.array([[0.1, -0.3], [-0.2, -0.2], [0.0, -0.1], [0.1, -0.05]])
    w = -slopes[:, 1] / 1.6
    fit = plane_through(slopes, w)
    plane, _ = limit_plane(fit.plane, 50.0, math.radians(8), slopes, w)
    assert plane.w0 == pytest.approx(0, abs=1e-9)
    assert math.degrees(tilt_and_swing(plane, 50.0)[0]) == pytest.approx(-math.degrees(math.asin(0.05 / 1.6)))


def test_a_soft_point_moves_the_plane_to_where_it_has_its_blur():
    places = np.array([[[-0.1, 0.0], [0.1, 0.0], [0.0, 0.1]]])
    targets = FocusTargets.from_columns(
        "abs", [[2.0, 2.0, 2.5]], kinds=["sharp", "sharp", "soft"], blurs_mm=[0, 0, 0.25], slopes=places
    )
    fits, wanted = fit_targets(targets, np.full((1, 3), 1 / 3), 1.25)
    assert wanted[0] == pytest.approx([0.5, 0.5, 0.4 + 0.2])
    plane = fits.at(0).plane
    assert abs(w_on(plane, places[0])[2] - 0.4) * 1.25 == pytest.approx(0.25)
    none, wanted = fit_targets(targets, np.full((1, 3), 1 / 3), 0.0)
    assert wanted[0] == pytest.approx([0.5, 0.5, 0.4])
    assert none.at(0).residual == pytest.approx(0, abs=1e-9)


def test_impossible_planes_and_numbers_are_refused():
    with pytest.raises(SettingsError, match=r"passes 0\.04 m beside the lens"):
        lens_axis(FocalPlane(1.0, 25.0), 50.0)
    with pytest.raises(SettingsError, match="largest angle"):
        limit_plane(FocalPlane(1.0), 50.0, math.pi / 2, [[0, 0]], [1.0])
    with pytest.raises(SettingsError, match="weights"):
        plane_through([[0, 0]], [1.0], [-1.0])
    with pytest.raises(SettingsError, match="finite places"):
        plane_through([[np.nan, 0]], [1.0])


def test_a_lens_tilted_by_hand_is_focused_to_serve_the_points():
    tilted = plane_of(math.radians(-4), math.radians(2), 3.0, 50.0)
    slopes = np.array([[[0.1, -0.2], [-0.2, 0.05]]])
    targets = FocusTargets.from_columns("ab", 1 / w_on(tilted, slopes), slopes=slopes)
    tilts = [[tilted.slope_x, tilted.slope_y]]
    assert solve_distances(targets, 9.0, tilts=tilts).focus_distance_m[0] == pytest.approx(3.0)
    beyond = FocusTargets.from_columns(
        "a", [[1 / 0.1]], slopes=[[[0.0, -0.2]]]
    )  # the plane would pass it only from behind the camera
    solved = solve_distances(beyond, 9.0, tilts=tilts).at(0)
    assert (solved.focus_distance_m, solved.limit, solved.states) == (math.inf, "infinity", ("used",))
