"""Dispersion formulas against the same formulas written out."""

from __future__ import annotations

import math

import numpy as np
import pytest

from render.model.lens import Dispersion
from render.optics.dispersion.formulas import index_and_abbe, index_at

LINES_NM = (400.0, 475.0, 546.074, 650.0, 700.0)


def _sellmeier(um: float) -> float:
    return math.sqrt(1.02 - 0.001 * um * um + 1.1 * um**2 / (um**2 - 0.01) + 0.2 * um**2 / (um**2 - 0.04))


def _powers(um: float) -> float:
    return math.sqrt(2.2705778 - 0.010059376 * um**2 + 0.010414999 / um**2 + 2.887e-4 / um**4)


def _conrady(um: float) -> float:
    return 1.5 + 0.009 / um + 5.5e-4 / um**3.5


def _herzberger(um: float) -> float:
    h = 1 / (um**2 - 0.028)
    return 1.5 + 0.005 * h + 1e-4 * h**2 - 0.002 * um**2 - 1e-4 * um**4 + 1e-6 * um**6


def _buchdahl(um: float) -> float:
    w = (um - 0.574) / (1 + 2.5 * (um - 0.574))
    return 1.614195 - 0.059075 * w + 7.5367e-4 * w**2


@pytest.mark.parametrize(
    ("dispersion", "written_out"),
    [
        (Dispersion("sellmeier", (1.02, -0.001, 1.1, 0.01, 0.2, 0.04)), _sellmeier),
        (Dispersion("powers", (2.2705778, 0, -0.010059376, 2, 0.010414999, -2, 2.887e-4, -4)), _powers),
        (Dispersion("cauchy", (1.5, 0, 0.009, -1, 5.5e-4, -3.5)), _conrady),
        (Dispersion("herzberger", (1.5, 0.005, 1e-4, -0.002, -1e-4, 1e-6)), _herzberger),
        (Dispersion("buchdahl", (1.614195, -0.059075, 7.5367e-4)), _buchdahl),
    ],
    ids=lambda value: value.formula if isinstance(value, Dispersion) else "",
)
def test_a_formula_is_what_its_name_says(dispersion: Dispersion, written_out) -> None:
    expected = [written_out(line / 1000) for line in LINES_NM]
    assert index_at(dispersion, np.array(LINES_NM)) == pytest.approx(expected, rel=1e-14)


def test_shapes_of_wavelengths_are_kept() -> None:
    dispersion = Dispersion("cauchy", (1.5, 0, 0.004, -2))
    assert index_at(dispersion, np.full((2, 3), 500.0)).shape == (2, 3)


def test_a_medium_without_dispersion_has_abbe_number_0() -> None:
    assert index_and_abbe(Dispersion("cauchy", (1.5, 0.0))) == (1.5, 0.0)
