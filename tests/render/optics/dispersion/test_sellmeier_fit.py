"""Glass of foreign catalogues, as a shot carries it."""

from __future__ import annotations

import numpy as np
import pytest

from render.optics.dispersion.sellmeier_fit import as_sellmeier
from render.optics.glass import refractive_index
from tests.render.kits.glasses import glass

VISIBLE_NM = np.linspace(400.0, 700.0, 151)


@pytest.mark.parametrize("name", ["FCD1", "J-BK7A", "J-LAF3", "K-PFK80", "H-ZF52", "PMMA"])
def test_a_fit_has_the_indices_of_the_formula(name: str) -> None:
    known = glass(name)
    assert known.dispersion is not None
    fitted = as_sellmeier(known)
    assert fitted.dispersion is None
    assert refractive_index(fitted, VISIBLE_NM) == pytest.approx(refractive_index(known, VISIBLE_NM), abs=3e-6)


def test_glass_of_sellmeiers_equation_stays_as_it_is() -> None:
    assert as_sellmeier(glass("N-BK7")) is glass("N-BK7")
