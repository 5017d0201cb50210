"""Surfaces with terms of odd powers: their shape, and rays that meet them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from render.errors import InputError
from render.lab.reference.lens_shape import SurfaceShape
from render.model.arrays import DoubleArray
from render.model.lens import Across, Glass, Prescription, Surface
from render.optics.prescription.completion import scale_prescription
from render.optics.prescription.surface_shape import extent_mm, intersect, sag_at, sag_mm, slopes_at
from render.optics.prescription.validation import check_prescription

GLASS = Glass(1.6, 60.0)
ODD = Surface(40.0, 6.0, GLASS, 12.0, conic=-0.4, aspheric=(2e-6, -1e-9), odd=(3e-5, -4e-7, 1e-9), across=None)


def _sag(r: DoubleArray) -> DoubleArray:
    """Formula of `ODD`, written out."""
    c = 1 / 40
    conic = c * r**2 / (1 + np.sqrt(1 - 0.6 * c**2 * r**2))
    return np.asarray(conic + 3e-5 * r**3 + 2e-6 * r**4 - 4e-7 * r**5 - 1e-9 * r**6 + 1e-9 * r**7)


def test_the_sag_is_the_sum_of_its_terms() -> None:
    r = np.linspace(0, 12, 25)
    np.testing.assert_allclose(sag_mm(ODD, r**2), _sag(r), rtol=1e-14)
    assert ODD.aspheric_terms == {3: 3e-5, 4: 2e-6, 5: -4e-7, 6: -1e-9, 7: 1e-9}


@pytest.mark.parametrize("across", [None, Across(-90.0, 0.5)])
def test_slopes_are_those_of_the_sag(across: Across | None) -> None:
    surface = Surface(40.0, 0.0, odd=(3e-5, -4e-7), aspheric=(2e-6,), across=across)
    points = np.random.default_rng(3).uniform(-8, 8, (50, 2))
    step = 1e-5
    by_steps = [
        (sag_at(surface, points + step * way) - sag_at(surface, points - step * way)) / (2 * step) for way in np.eye(2)
    ]
    np.testing.assert_allclose(slopes_at(surface, points), np.stack(by_steps, axis=1), atol=1e-9)
    assert not slopes_at(surface, np.zeros((1, 2))).any()


def test_rays_meet_the_surface_where_bracketing_finds_it() -> None:
    """Each of many slanted rays against Brent's method on the written formula."""
    random = np.random.default_rng(5)
    starts = np.concatenate([random.uniform(-6, 6, (60, 2)), np.full((60, 1), -3.0)], axis=1)
    headings = np.concatenate([random.uniform(-0.4, 0.4, (60, 2)), np.ones((60, 1))], axis=1)
    headings /= np.linalg.norm(headings, axis=1)[:, None]
    met, hit = intersect(ODD, starts, headings)
    assert hit.all()

    def miss(distance: float, start: DoubleArray, heading: DoubleArray) -> float:
        x, y, z = start + distance * heading
        return float(z - _sag(np.hypot(x, y)))

    wanted = [
        start + brentq(miss, 0, 15, args=(start, heading), xtol=1e-14) * heading
        for start, heading in zip(starts, headings, strict=True)
    ]
    np.testing.assert_allclose(met, wanted, atol=1e-11)


def test_odd_powers_alone_bend_a_plane() -> None:
    plane = Surface(0.0, 0.0, GLASS, 8.0, odd=(1e-3,))
    met, hit = intersect(plane, np.array([[0.0, 5.0, -2.0]]), np.array([[0.0, 0.0, 1.0]]))
    assert hit[0]
    assert met[0, 2] == pytest.approx(0.125)
    assert extent_mm(Surface(0.0, 0.0, odd=(1e-3,))) == pytest.approx(np.sqrt(1000), rel=0.02)  # slope 3e-3·r² of 3


def test_the_reference_tracer_knows_odd_powers() -> None:
    shape = SurfaceShape.of(ODD, None, clip=True)
    points = np.random.default_rng(6).uniform(-8, 8, (40, 2))
    sag, by_x, by_y = shape.at(points[:, 0], points[:, 1])
    np.testing.assert_allclose(sag, _sag(np.hypot(*points.T)), rtol=1e-13)
    np.testing.assert_allclose(np.stack([by_x, by_y], axis=1), slopes_at(ODD, points), atol=1e-14)


def test_a_scaled_lens_has_scaled_odd_powers() -> None:
    scaled = scale_prescription(Prescription((ODD,)), 2.5).surfaces[0]
    r = np.linspace(0, 12, 9)
    np.testing.assert_allclose(sag_mm(scaled, (2.5 * r) ** 2), 2.5 * _sag(r), rtol=1e-13)


@pytest.mark.parametrize(
    ("odd", "message"),
    [
        ((float("nan"),), r"aspheric coefficient of r\^3 must be a finite number"),
        ((0.0, 1e9), r"aspheric coefficient of r\^5 must be at most"),
        ((1e-9,) * 11, "at most 10 odd aspheric coefficients, got 11"),
    ],
)
def test_impossible_odd_powers_are_refused(odd: tuple[float, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_prescription(Prescription((Surface(40.0, 5.0, GLASS, odd=odd), Surface(-40.0, 0.0, is_stop=True))))
