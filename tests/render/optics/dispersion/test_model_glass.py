"""Glass known by index and Abbe number alone is dispersed as glasses of the makers are."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.model.lens import AIR, Glass, Prescription, Surface
from render.optics.dispersion.lines import D_LINE_NM, F_LINE_NM
from render.optics.dispersion.model_glass import model_index, partial_dispersions
from render.optics.glass import refractive_index
from render.optics.lens_files import parse_lens_file
from render.optics.prescription.paraxial import first_order
from tests.render.kits.glasses import glass
from tests.render.kits.lens_files import DOUBLE_GAUSS_SEQ
from tests.render.kits.lenses import DOUBLE_GAUSS

THREE_NM = (475.0, 510.0, 650.0)
# Tronnier's double Gauss (US 2,673,491) in the glasses that its indices belong to (Smith, Modern Lens Design).
_TRONNIER_GLASSES = iter(["N-BAF10", "N-BAF10", "SF15", "F5", "LAK11", "N-LAF3"])
TRONNIER = replace(
    DOUBLE_GAUSS.prescription,
    surfaces=tuple(
        surface if surface.glass == AIR else replace(surface, glass=glass(next(_TRONNIER_GLASSES)))
        for surface in DOUBLE_GAUSS.prescription.surfaces
    ),
)
CODE_V_EXAMPLE = parse_lens_file(DOUBLE_GAUSS_SEQ.encode(), "double gauss.seq")


def _axial_colour_mm(lens: Prescription) -> np.ndarray:
    yellow = first_order(lens, D_LINE_NM).back_focal_mm
    return np.array([first_order(lens, line).back_focal_mm - yellow for line in THREE_NM])


def _as_model(surface: Surface) -> Surface:
    """The surface with its glass as a data sheet writes it: n_d to five places and V_d to two."""
    known = surface.glass
    return surface if known == AIR else replace(surface, glass=Glass(round(known.index, 5), round(known.abbe, 2)))


@pytest.mark.parametrize("lens", [CODE_V_EXAMPLE, TRONNIER], ids=["CODE V", "Tronnier"])
def test_axial_colour_of_model_glass_is_that_of_the_catalogue(lens: Prescription) -> None:
    model = replace(lens, surfaces=tuple(map(_as_model, lens.surfaces)))
    assert _axial_colour_mm(model) == pytest.approx(_axial_colour_mm(lens), rel=0.03)


# B1, C1, B2, C2, B3, C3 of Schott's data sheets.
SCHOTT = {
    "N-SSK2": (1.4306027, 0.00823982975, 0.153150554, 0.0333736841, 1.01390904, 106.870822),
    "N-SK2": (1.28189012, 0.0072719164, 0.257738258, 0.0242823527, 0.96818604, 110.377773),
    "F5": (1.3104463, 0.00958633048, 0.19603426, 0.0457627627, 0.96612977, 115.011883),
    "N-SK16": (1.34317774, 0.00704687339, 0.241144399, 0.0229005, 0.994317969, 92.7508526),
}


def _index(name: str, um: float) -> float:
    c = SCHOTT[name]
    return math.sqrt(1 + sum(b * um**2 / (um**2 - pole) for b, pole in zip(c[::2], c[1::2], strict=True)))


def _back_focus_mm(nm: float) -> float:
    """Where parallel light near the axis crosses it behind the double Gauss, traced surface by surface."""
    before, height, slope = 1.0, 1.0, 0.0  # slope times index
    for surface in CODE_V_EXAMPLE.surfaces:
        behind = _index(surface.glass.name, nm / 1000) if surface.glass.name else 1.0
        slope -= height * (behind - before) / surface.radius_mm if surface.radius_mm else 0.0
        crossing = -height / slope if slope else math.inf
        height += surface.thickness_mm * slope / behind
        before = behind
    return crossing


def test_a_double_gauss_has_the_axial_colour_of_its_glasses() -> None:
    expected = [_back_focus_mm(line) - _back_focus_mm(D_LINE_NM) for line in THREE_NM]
    assert _axial_colour_mm(CODE_V_EXAMPLE) == pytest.approx(expected, abs=1e-6)
    assert expected[0] == pytest.approx(-0.053, abs=0.0005)


@given(index=st.floats(1.3, 2.2), abbe=st.floats(15, 95))
def test_any_model_glass_falls_smoothly_from_blue_to_red(index: float, abbe: float) -> None:
    indices = model_index(index, abbe, np.linspace(395.0, 710.0, 64))
    assert (np.diff(indices) < 0).all()
    assert (np.diff(indices, 2) > 0).all()


@pytest.mark.parametrize("name", ["N-BK7", "N-SF11", "S-FPL53", "N-KZFS4", "S-LAH79", "FCD1", "H-ZF88"])
def test_a_glass_by_its_numbers_is_itself(name: str) -> None:
    known, wavelengths = glass(name), np.linspace(400.0, 700.0, 31)
    model = model_index(known.index, known.abbe, wavelengths)
    spread = (known.index - 1) / known.abbe
    assert model == pytest.approx(refractive_index(known, wavelengths), abs=3e-3 * spread)


def test_between_glasses_the_dispersion_is_near_the_normal_line() -> None:
    # Schott's normal line through K7 and F2: P_gF = 0.6438 − 0.001682·V_d.
    for index, abbe in ((1.53, 58.0), (1.60, 42.0), (1.64, 34.5)):
        assert partial_dispersions(index, abbe)[1] == pytest.approx(0.6438 - 0.001682 * abbe, abs=0.006)


def test_index_and_dispersion_are_met_exactly() -> None:
    n_d, n_f, n_c = model_index(1.62, 41.5, np.array([D_LINE_NM, F_LINE_NM, 656.2725]))
    assert n_d == pytest.approx(1.62, abs=1e-12)
    assert (n_d - 1) / (n_f - n_c) == pytest.approx(41.5, rel=1e-9)
