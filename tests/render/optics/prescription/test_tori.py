"""Tori: a curve that is turned about an axis across it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.model.lens import Across, Glass, Prescription, Surface
from render.optics.prescription.completion import scale_prescription
from render.optics.prescription.meridians import turned, upright
from render.optics.prescription.surface_shape import conic_extent_mm, extent_mm, sag_at, sag_mm, slopes_at
from render.optics.prescription.tracing import trace_forward
from render.optics.prescription.validation import check_prescription

GLASS = Glass(1.5)
N = 1.5
SURFACES = {
    "barrel": Surface(30.0, 9.0, GLASS, across=Across(70.0, torus="upright")),
    "saddle": Surface(-35.0, 9.0, GLASS, conic=-2.0, aspheric=(3e-6, -1e-8), across=Across(50.0, torus="upright")),
    "odd": Surface(60.0, 9.0, GLASS, odd=(2e-5,), conic=0.5, across=Across(-45.0, torus="upright")),
    "acylinder": Surface(0.0, 9.0, GLASS, aspheric=(4e-6,), across=Across(40.0, -0.6, torus="across")),
    "lying": Surface(55.0, 9.0, GLASS, aspheric=(-5e-6, 2e-9), across=Across(-80.0, 1.5, torus="across")),
}


def _grid(reach: float, count: int = 9) -> DoubleArray:
    line = np.linspace(-reach, reach, count)
    return np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)


def _curve(surface: Surface, at: float) -> float:
    """Height of the curve that is turned."""
    across = surface.across or Across()
    radius, conic = (
        (surface.radius_mm, surface.conic) if across.torus == "upright" else (across.radius_mm, across.conic)
    )
    c = 1 / radius if radius else 0.0
    base = c * at * at / (1 + np.sqrt(1 - (1 + conic) * c * c * at * at))
    return float(base + sum(value * abs(at) ** power for power, value in surface.aspheric_terms.items()))


def _behind(surface: Surface, point: DoubleArray) -> float:
    """Equation of the torus, of points anywhere: 0 on it, above behind it. A turned point keeps its distance from the axis."""
    across = surface.across or Across()
    along, beside = (point[1], point[0]) if across.torus == "upright" else (point[0], point[1])
    turn = across.radius_mm if across.torus == "upright" else surface.radius_mm
    if not turn:
        return float(point[2] - _curve(surface, along))
    return float(turn - np.copysign(np.hypot(beside, turn - point[2]), turn) - _curve(surface, along))


@pytest.mark.parametrize("name", SURFACES)
def test_slopes_of_a_torus_are_those_of_its_sag(name: str) -> None:
    surface, points, step = SURFACES[name], _grid(11.0), 1e-4
    by_steps = [
        (sag_at(surface, points + step * way) - sag_at(surface, points - step * way)) / (2 * step) for way in np.eye(2)
    ]
    np.testing.assert_allclose(slopes_at(surface, points), np.stack(by_steps, axis=1), atol=1e-8)


@pytest.mark.parametrize("name", SURFACES)
def test_rays_agree_with_an_independent_trace(name: str) -> None:
    """Bisection of the turned curve's own equation, and Snell's law with a gradient by differences."""
    surface = SURFACES[name]
    rng = np.random.default_rng(3)
    starts = np.concatenate([rng.uniform(-9, 9, (40, 2)), np.full((40, 1), -5.0)], axis=1)
    headings = np.concatenate([rng.uniform(-0.3, 0.3, (40, 2)), np.ones((40, 1))], axis=1)
    headings /= np.linalg.norm(headings, axis=1)[:, None]
    rays = trace_forward(Prescription((surface,)), starts, headings)
    assert rays.passes.all()
    for start, heading, met, leaving in zip(starts, headings, rays.points_mm[0], rays.directions, strict=True):
        way = brentq(lambda t: _behind(surface, start + t * heading), 0.0, 12.0, xtol=1e-13)  # noqa: B023
        point = start + way * heading
        np.testing.assert_allclose(met, point, atol=1e-9)
        step = 1e-5 * np.eye(3)
        normal = np.array([_behind(surface, point + each) - _behind(surface, point - each) for each in step])
        normal /= np.linalg.norm(normal)
        crossed = np.cross(normal, heading) / N
        np.testing.assert_allclose(np.cross(normal, leaving), crossed, atol=1e-8)


def test_a_torus_of_equal_radii_is_a_sphere() -> None:
    plain = Surface(40.0, 9.0, GLASS)
    torus = replace(plain, across=Across(40.0, torus="upright"))
    points = _grid(13.0)
    np.testing.assert_allclose(sag_at(torus, points), sag_at(plain, points), atol=1e-13)
    assert conic_extent_mm(torus) == pytest.approx(40.0, rel=1e-6)


def test_a_torus_is_no_biconic() -> None:
    torus, points = SURFACES["barrel"], np.array([[10.0, 10.0], [10.0, 0.0], [0.0, 10.0]])
    biconic = replace(torus, across=Across(70.0))
    difference = np.abs(sag_at(torus, points) - sag_at(biconic, points))
    assert difference[0] > 1e-3
    assert difference[1:].max() < 1e-12


def test_an_acylinder_has_one_profile() -> None:
    """Without a radius of the turn the profile is the same at all places along it."""
    surface, points = SURFACES["acylinder"], _grid(10.0)
    np.testing.assert_allclose(sag_at(surface, points), sag_at(surface, points * [1.0, 0.0]), atol=0)


@pytest.mark.parametrize("name", SURFACES)
def test_a_turned_torus_exchanges_x_and_y(name: str) -> None:
    surface, points = SURFACES[name], _grid(10.0)
    (other,) = turned(Prescription((surface,))).surfaces
    np.testing.assert_allclose(sag_at(other, points[:, ::-1]), sag_at(surface, points), atol=1e-14)
    assert turned(turned(Prescription((surface,)))).surfaces == (surface,)


@pytest.mark.parametrize("name", SURFACES)
def test_the_upright_lens_has_the_upright_curve(name: str) -> None:
    surface, heights = SURFACES[name], np.linspace(0, 11, 12)
    (plain,) = upright(Prescription((surface,))).surfaces
    up = np.stack([np.zeros(12), heights], axis=1)
    np.testing.assert_allclose(sag_at(plain, up), sag_at(surface, up), atol=1e-14)
    np.testing.assert_allclose(sag_mm(surface, heights**2), sag_at(surface, up), atol=1e-14)


def test_a_scaled_torus_is_a_torus() -> None:
    points = _grid(9.0)
    for surface in SURFACES.values():
        (large,) = scale_prescription(Prescription((surface,)), 2.0).surfaces
        np.testing.assert_allclose(sag_at(large, 2 * points), 2 * sag_at(surface, points), atol=1e-12)


def test_a_torus_ends_where_its_curve_meets_the_axis() -> None:
    """A curve bent toward the axis of the turn reaches less far than its own sphere."""
    surface = Surface(30.0, 9.0, GLASS, across=Across(20.0, torus="upright"))
    assert conic_extent_mm(surface) == pytest.approx(20.0, rel=1e-4)
    assert extent_mm(surface) <= 20.0
    inner = Surface(0.0, 9.0, GLASS, aspheric=(1e-3,), across=Across(10.0, torus="upright"))
    assert conic_extent_mm(inner) < 10.0
    assert conic_extent_mm(SURFACES["acylinder"]) == pytest.approx(40 / np.sqrt(0.4))


@pytest.mark.parametrize(
    ("across", "conic", "message"),
    [
        (Across(50.0, -1.0, "upright"), 0.0, "a torus whose curve from side to side is a circle has no conic constant"),
        (Across(50.0, 0.0, "across"), -1.0, "a torus whose curve from top to bottom is a circle has no conic constant"),
        (Across(5.0, torus="upright"), 0.0, "radii of 40 and 5 mm let it reach"),
    ],
)
def test_impossible_tori_are_refused(across: Across, conic: float, message: str) -> None:
    lens = Prescription((Surface(40.0, 5.0, GLASS, 8.0, conic, across=across), Surface(-40.0, 0.0, is_stop=True)))
    with pytest.raises(InputError, match=message):
        check_prescription(lens)
