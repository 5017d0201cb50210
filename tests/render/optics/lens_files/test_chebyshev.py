"""Surfaces of Chebyshev polynomials, of files by optiland."""

from __future__ import annotations

import json

import numpy as np
import pytest
from numpy.polynomial import chebyshev

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.model.lens import Prescription, Surface
from render.optics.lens_files import parse_lens_file
from render.optics.lens_files.chebyshev import round_part
from render.optics.prescription.paraxial import vertices
from render.optics.prescription.surface_shape import sag_at

NORM_MM = 12.0
AXIS = {"x": 0.0, "y": 0.0, "z": 0.0, "rx": 0.0, "ry": 0.0, "rz": 0.0}


def _of_powers(terms: dict[int, float], lengths: tuple[float, float] = (NORM_MM, NORM_MM)) -> DoubleArray:
    """Coefficients of Chebyshev polynomials of a sum of powers of r, by interpolation."""
    count = max(terms) + 1
    nodes = np.cos(np.pi * (np.arange(count) + 0.5) / count)
    x, y = np.meshgrid(nodes * lengths[0], nodes * lengths[1], indexing="ij")
    values = sum(value * (x * x + y * y) ** (power // 2) for power, value in terms.items())
    inverse = np.linalg.inv(chebyshev.chebvander(nodes, count - 1))
    return inverse @ values @ inverse.T


def _read(terms: DoubleArray, **geometry: object) -> tuple[Surface, ...]:
    shape = {"type": "ChebyshevPolynomialGeometry", "cs": AXIS, "radius": 40.0, "conic": -0.4, "norm_x": NORM_MM}
    shape |= {"norm_y": NORM_MM, "coefficients": terms.tolist()} | geometry
    plane = {"geometry": {"type": "Plane", "cs": AXIS}, "thickness": 1e12}
    air, glass = ({"type": "AbbeMaterial", "index": n, "abbe": 60.0} for n in (1.0, 1.5))
    rim = {"type": "RadialAperture", "r_max": 10.0, "r_min": 0.0}
    front = {"geometry": {"type": "StandardGeometry", "cs": AXIS, "radius": 60.0}, "thickness": 5.0}
    front |= {"material_post": glass, "aperture": rim}
    middle = {"geometry": shape, "thickness": 7.0, "material_post": air, "is_stop": True, "aperture": rim}
    back = {"geometry": {"type": "StandardGeometry", "cs": AXIS, "radius": 60.0}, "thickness": 4.0}
    last = {"geometry": {"type": "Plane", "cs": AXIS}, "thickness": 80.0, "material_post": air}
    surfaces = [plane, front, middle, back | {"material_post": glass}, last, plane]
    model = {"surface_group": {"surfaces": surfaces}, "aperture": {"type": "EPD", "value": 10.0}}
    return parse_lens_file(json.dumps(model).encode(), "a.json").surfaces


def test_symmetric_terms_become_even_powers() -> None:
    terms = {4: 2e-5, 6: -3e-8, 8: 1e-10}
    front = _read(_of_powers(terms))[1]
    assert front.aspheric == pytest.approx((2e-5, -3e-8, 1e-10), rel=1e-9)
    assert (front.radius_mm, front.conic) == (40.0, -0.4)


def test_coefficients_may_be_an_array_of_an_object() -> None:
    terms = _of_powers({4: 2e-5, 6: -3e-8, 8: 1e-10})
    array = {"__ndarray__": terms.tolist(), "dtype": "float64", "shape": list(terms.shape)}
    assert _read(terms, coefficients=array) == _read(terms)


def test_unequal_lengths_may_be_symmetric() -> None:
    lengths = (12.0, 15.0)
    part = round_part(_of_powers({4: 2e-5, 8: 1e-10}, lengths), lengths, 12.0)
    assert part.terms[4] == pytest.approx(2e-5, rel=1e-9)
    assert part.left_over < 1e-12


def test_a_constant_moves_the_vertex() -> None:
    coefficients = _of_powers({4: 2e-5})
    coefficients[0, 0] += 0.25
    surfaces = _read(coefficients)
    assert vertices(Prescription(surfaces)) == pytest.approx([0.0, 5.25, 12.0, 16.0])


def test_a_term_of_r_squared_is_fitted() -> None:
    front = _read(_of_powers({2: 1e-3, 4: 2e-5}))[1]
    r = np.linspace(0, 10.0, 50)
    sag = sag_at(front, np.stack([r * 0.6, r * 0.8], axis=1))
    c = 1 / 40.0
    wanted = c * r**2 / (1 + np.sqrt(1 - 0.6 * c * c * r**2)) + 1e-3 * r**2 + 2e-5 * r**4
    np.testing.assert_allclose(sag, wanted, atol=1e-9)


def test_freeform_terms_are_refused_by_their_size() -> None:
    coefficients = _of_powers({4: 2e-5})
    coefficients[2, 0] += 1e-6
    with pytest.raises(InputError, match=r"surface 2.* without rotational symmetry .* depart from it by .*e-07 mm"):
        _read(coefficients)


@pytest.mark.parametrize(
    ("geometry", "message"),
    [
        ({"norm_x": 0.0}, "norm_x and norm_y must be at least"),
        ({"norm_y": 9.0}, "clear semi-diameter of 10 exceeds norm_x or norm_y"),
        ({"coefficients": [[0.0, 1.0], [1.0]]}, "expected rows of the same length"),
        ({"coefficients": [[0.0] * 22]}, "expected at most 21 entries, got 22"),
        ({"coefficients": [0.0, 1.0]}, "expected a list"),
        ({"coefficients": {"__ndarray__": [[0.0] * 22]}}, "expected at most 21 entries, got 22"),
        ({"coefficients": [[0.0, 1e308, 1e308]]}, "without rotational symmetry"),
    ],
)
def test_impossible_polynomials_are_refused(geometry: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        _read(_of_powers({4: 1e-5}), **geometry)
