"""Aspheres of files as conics and powers: Forbes's polynomials, odd powers, terms of r²."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.special import eval_jacobi

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.model.lens import Surface
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.file_shapes import FileShape, shape_in_mm
from render.optics.lens_files.forbes import ForbesTerms, qcon_terms
from render.optics.lens_files.lens_text import LensText
from render.optics.prescription.surface_shape import sag_mm

TEXT = LensText("a.zmx", ())
# Qbfs_0 to Qbfs_4 of x = u² as the paper lists them (Forbes 2007, eq. 15)
QBFS: tuple[Callable[[DoubleArray], DoubleArray], ...] = (
    lambda x: np.ones_like(x),
    lambda x: (13 - 16 * x) / np.sqrt(19),
    lambda x: np.sqrt(2 / 95) * (29 - 4 * x * (25 - 19 * x)),
    lambda x: np.sqrt(2 / 2545) * (207 - 4 * x * (315 - x * (577 - 320 * x))),
    lambda x: (7737 - 16 * x * (4653 - 2 * x * (7381 - 8 * x * (1168 - 509 * x)))) / (3 * np.sqrt(131831)),
)


def _shape(radius: float, conic: float = 0.0, unit: float = 1.0, width: float = 10.0, **shape: Any) -> FileShape:
    surface = DraftSurface("3", 7, radius=radius, conic=conic, semi_diameter=width, **shape)
    return shape_in_mm(surface, unit, TEXT)


def _sag(shape: FileShape, r: DoubleArray) -> DoubleArray:
    return sag_mm(Surface(shape.radius_mm, 0.0, conic=shape.conic, aspheric=shape.aspheric, odd=shape.odd), r**2)


def _conic(radius: float, conic: float, r: DoubleArray) -> DoubleArray:
    return np.asarray(r**2 / radius / (1 + np.sqrt(1 - (1 + conic) * (r / radius) ** 2)))


def test_qcon_terms_are_even_powers_exactly() -> None:
    coefficients = (0.02, -0.004, 1e-3, 0.0, -2e-4, 1e-4, 3e-5, -1e-5, 4e-6)
    shape = _shape(30.0, -0.7, forbes=ForbesTerms("Qcon", coefficients, 11.0))
    r = np.linspace(0, 11, 45)
    x = (r / 11) ** 2
    departure = x**2 * sum(a * eval_jacobi(m, 0, 4, 2 * x - 1) for m, a in enumerate(coefficients))
    np.testing.assert_allclose(_sag(shape, r), _conic(30.0, -0.7, r) + departure, atol=1e-13)
    assert (shape.radius_mm, shape.conic, shape.note) == (30.0, -0.7, "")
    assert qcon_terms(ForbesTerms("Qcon", (0.0, 1.0), 1.0)) == {4: -5.0, 6: 6.0}


def test_qbfs_terms_are_fitted_within_what_the_note_says() -> None:
    coefficients = (0.05, -0.008, 2e-3, 4e-4, -1e-4)
    shape = _shape(45.0, forbes=ForbesTerms("Qbfs", coefficients, 12.0), width=11.5)
    r = np.linspace(0, 11.5, 200)
    x = (r / 12) ** 2
    series = sum(a * polynomial(x) for a, polynomial in zip(coefficients, QBFS, strict=True))
    true = _conic(45.0, 0.0, r) + x * (1 - x) * series / np.sqrt(1 - (r / 45) ** 2)
    np.testing.assert_allclose(_sag(shape, r), true, atol=2e-7)
    assert shape.note.startswith("Surface 3 is a conic with even powers up to r^20 in place of its Qbfs terms: within ")
    vertex = 1 / 45 + 2 * sum(a * q(np.zeros(1))[0] for a, q in zip(coefficients, QBFS, strict=True)) / 144
    assert 1 / shape.radius_mm == pytest.approx(vertex, rel=1e-12)


def test_qbfs_terms_of_a_plane_are_exact() -> None:
    shape = _shape(0.0, forbes=ForbesTerms("Qbfs", (0.05, -0.008), 12.0), width=12.0)
    x = np.linspace(0, 1, 50) ** 2
    true = x * (1 - x) * (0.05 - 0.008 * QBFS[1](x))
    np.testing.assert_allclose(_sag(shape, 12 * np.sqrt(x)), true, atol=1e-14)


def test_a_file_in_inches_gives_the_same_qcon_shape() -> None:
    inches = _shape(1.2, -0.7, 25.4, 0.4, forbes=ForbesTerms("Qcon", (0.002, -0.0001), 0.5))
    mm = _shape(30.48, -0.7, forbes=ForbesTerms("Qcon", (0.0508, -0.00254), 12.7))
    np.testing.assert_allclose(inches.aspheric, mm.aspheric, rtol=1e-12)


def test_a_term_of_r2_on_a_curved_surface_is_fitted() -> None:
    shape = _shape(30.0, -0.5, terms={2: 2e-3, 4: 1e-6, 5: 3e-8})
    r = np.linspace(0, 10, 100)
    true = _conic(30.0, -0.5, r) + 2e-3 * r**2 + 1e-6 * r**4 + 3e-8 * r**5
    np.testing.assert_allclose(_sag(shape, r), true, atol=1e-8)
    assert 1 / shape.radius_mm == pytest.approx(1 / 30 + 4e-3)
    assert shape.odd == (0.0, 3e-8)


def test_powers_beyond_r20_are_fitted() -> None:
    shape = _shape(30.0, terms={4: 1e-6, 24: 1e-27, 30: -1e-34})
    r = np.linspace(0, 10, 100)
    true = _conic(30.0, 0.0, r) + 1e-6 * r**4 + 1e-27 * r**24 - 1e-34 * r**30
    np.testing.assert_allclose(_sag(shape, r), true, atol=1e-5)
    assert len(shape.aspheric) == 9


@pytest.mark.parametrize(
    ("surface", "message"),
    [
        ({"radius": 30.0, "terms": {1: 1e-3}}, r"line 7, surface 3: a term of r\^1 is not supported"),
        ({"radius": 30.0, "terms": {21: 1e-30}}, r"odd powers are supported up to r\^19, got r\^21"),
        ({"radius": 30.0, "terms": {2: 1e-3}, "width": 0.0}, r"a term of r\^2 is supported on .* clear diameter"),
        ({"radius": 30.0, "terms": {40: 1e-38}}, r"terms beyond r\^20 cannot be told by .* the best of them is"),
        (
            {"radius": 30.0, "conic": -1.0, "forbes": ForbesTerms("Qbfs", (0.1,), 10.0)},
            "Qbfs terms depart from a sphere: the conic constant must be 0, got -1",
        ),
        ({"radius": 30.0, "terms": {2: 1e300, 40: 1e300}}, "cannot be told by"),
        ({"radius": 30.0, "forbes": ForbesTerms("Qcon", (0.1,), 1e-200)}, "normalisation radius must be from 0.001 to"),
        ({"radius": 30.0, "forbes": ForbesTerms("Qbfs", (1e300, 1e300), 9.0)}, "its Qbfs terms cannot be told by"),
        (
            {"radius": 10.1, "forbes": ForbesTerms("Qbfs", (0.1, 0.1, 0.1), 10.0)},
            "its Qbfs terms cannot be told by a conic and even powers",
        ),
    ],
)
def test_shapes_that_the_model_has_not_are_refused(surface: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        _shape(**surface)
