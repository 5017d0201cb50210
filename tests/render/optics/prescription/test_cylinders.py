"""Surfaces with another curve from side to side than from top to bottom, by closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.model.lens import Across, Glass, Prescription, Surface
from render.optics.prescription.completion import scale_prescription
from render.optics.prescription.surface_shape import clearance_mm, conic_extent_mm, sag_at, slopes_at
from render.optics.prescription.tracing import Fate, trace_forward
from render.optics.prescription.validation import check_prescription

GLASS = Glass(1.5)
N = 1.5
RADIUS = 40.0
ELLIPSE = (
    -1 / N**2
)  # a surface of this conic constant makes parallel light meet in one point (Born & Wolf 1999, section 4.2)
FOCUS = N * RADIUS / (N - 1)  # behind it


def parallel(points: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Points ``(n, 3)`` and directions of rays along the axis at points ``(n, 2)``."""
    starts = np.concatenate([points, np.full((len(points), 1), -30.0)], axis=1)
    return starts, np.tile([0.0, 0.0, 1.0], (len(points), 1))


def grid(reach: float, count: int = 9) -> DoubleArray:
    line = np.linspace(-reach, reach, count)
    return np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)


def test_an_elliptical_cylinder_makes_a_line_of_light() -> None:
    """Rays at all heights meet the line x = 0, and keep their y, without aberration."""
    lens = Prescription((Surface(0.0, FOCUS, GLASS, across=Across(RADIUS, ELLIPSE)),))
    points = grid(18.0)
    line = trace_forward(lens, *parallel(points)).at(FOCUS)
    np.testing.assert_allclose(line, points * [0.0, 1.0], atol=1e-11)


def test_crossed_cylinders_focus_each_its_own_plane() -> None:
    """Near the axis: each by its own power, the second one's line behind the first one's by their distance over n."""
    apart = 5.0
    lens = Prescription(
        (Surface(RADIUS, apart, GLASS, across=Across(0.0)), Surface(0.0, 0.0, Glass(1.8), across=Across(RADIUS)))
    )
    height = 1e-4
    near = trace_forward(lens, *parallel(np.array([[height, 0.0], [0.0, height]])))
    slopes = near.directions[:, :2] / near.directions[:, 2:]
    across = height * (1.8 - 1.5) / RADIUS / 1.8
    upright = (N - 1) * height / RADIUS / 1.8  # a flat surface leaves n·slope
    np.testing.assert_allclose(slopes, -np.diag([across, upright]), rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("terms", [(), (2e-6, -3e-9)])
@pytest.mark.parametrize("conic", [0.0, -0.7])
def test_equal_curves_are_a_surface_of_revolution(conic: float, terms: tuple[float, ...]) -> None:
    plain = Surface(RADIUS, 10.0, GLASS, conic=conic, aspheric=terms)
    rng = np.random.default_rng(5)
    starts, headings = parallel(rng.uniform(-15, 15, (200, 2)))
    headings = headings + np.concatenate([rng.uniform(-0.3, 0.3, (200, 2)), np.zeros((200, 1))], axis=1)
    headings /= np.linalg.norm(headings, axis=1)[:, None]
    one, other = (
        trace_forward(Prescription((surface,)), starts, headings)
        for surface in (plain, replace(plain, across=Across(RADIUS, conic)))
    )
    np.testing.assert_allclose(other.points_mm, one.points_mm, atol=1e-12)
    np.testing.assert_allclose(other.directions, one.directions, atol=1e-12)
    assert one.passes.sum() > 150


def test_slopes_are_those_of_the_sag() -> None:
    surface = Surface(RADIUS, 0.0, conic=0.4, aspheric=(1e-6,), across=Across(-90.0, -2.0))
    points, step = grid(12.0), 1e-4
    by_steps = [
        (sag_at(surface, points + step * way) - sag_at(surface, points - step * way)) / (2 * step) for way in np.eye(2)
    ]
    np.testing.assert_allclose(slopes_at(surface, points), np.stack(by_steps, axis=1), atol=1e-8)


def test_a_turned_lens_turns_its_rays() -> None:
    """Exchanging both curves exchanges x and y."""
    lens = Prescription(
        (Surface(35.0, 8.0, GLASS, across=Across(-80.0)), Surface(-60.0, 20.0, across=Across(45.0, -1.0)))
    )
    turned = Prescription(
        tuple(
            replace(s, radius_mm=s.across.radius_mm, conic=s.across.conic, across=Across(s.radius_mm, s.conic))
            for s in lens.surfaces
            if s.across
        )
    )
    starts, headings = parallel(grid(9.0) + np.array([0.3, 0.0]))
    headings = headings + np.array([0.1, -0.2, 0.0])
    headings /= np.linalg.norm(headings, axis=1)[:, None]
    there, here = (
        trace_forward(lens, starts, headings),
        trace_forward(turned, starts[:, [1, 0, 2]], headings[:, [1, 0, 2]]),
    )
    assert there.passes.all()
    np.testing.assert_allclose(here.directions[:, [1, 0, 2]], there.directions, atol=1e-12)


def test_a_cylinder_ends_where_it_turns_back() -> None:
    surface = Surface(0.0, 5.0, GLASS, across=Across(10.0))
    rays = trace_forward(
        Prescription((surface,)), *parallel(np.array([[9.3, 0.0], [0.0, 9.3], [10.1, 0.0], [0.0, 50.0]]))
    )
    assert rays.fates.tolist() == [Fate.PASSES, Fate.PASSES, Fate.MISSES, Fate.MISSES]
    assert conic_extent_mm(surface) == pytest.approx(10.0)


def test_cylinders_meet_from_side_to_side() -> None:
    """A positive and a flat surface touch at the rim of the plane in which the first one is curved."""
    front, behind = (
        Surface(0.0, 1.0, GLASS, 8.0, across=Across(-40.0)),
        Surface(0.0, 1.0, semi_diameter_mm=8.0, across=Across(-20.0)),
    )
    deep = 20 - np.sqrt(20**2 - 64) - (40 - np.sqrt(40**2 - 64))
    assert clearance_mm(front, behind, 1.0) == pytest.approx(1.0 - deep, abs=1e-6)


def test_a_scaled_lens_is_scaled_in_both_planes() -> None:
    lens = Prescription((Surface(0.0, 5.0, GLASS, across=Across(10.0, -0.5)),))
    assert scale_prescription(lens, 3.0).surfaces[0].across == Across(30.0, -0.5)


@pytest.mark.parametrize(
    ("across", "semi_mm", "message"),
    [
        (Across(float("nan")), 0.0, "radius across must be a finite number"),
        (Across(1e-5), 0.0, "radius across must be 0"),
        (Across(50.0, float("inf")), 0.0, "conic constant across must be a finite number"),
        (Across(5.0), 8.0, "radii of 40 and 5 mm let it reach"),
    ],
)
def test_impossible_curves_are_refused(across: Across, semi_mm: float, message: str) -> None:
    lens = Prescription((Surface(RADIUS, 5.0, GLASS, semi_mm, across=across), Surface(-RADIUS, 0.0, is_stop=True)))
    with pytest.raises(InputError, match=message):
        check_prescription(lens)
