"""Glass and light: indices against published tables, and white that stays white."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import SettingsError
from render.model.lens import AIR, Glass
from render.optics.glass import C_LINE_NM, D_LINE_NM, F_LINE_NM, refractive_index
from render.optics.spectrum import THREE_LINES, colour_matching, spectrum
from tests.render.kits.glasses import glass as named

OF_EACH_KIND = {
    "sellmeier": named("N-SF10"),
    "formula": named("FCD1"),
    "model": Glass(1.6, 40.0),
    "constant": Glass(1.6),
    "air": AIR,
}


@pytest.mark.parametrize("kind", ["sellmeier", "formula", "model"])
def test_the_index_and_abbe_number_are_those_of_the_dispersion(kind: str) -> None:
    glass = OF_EACH_KIND[kind]
    n_d, n_f, n_c = (refractive_index(glass, line) for line in (D_LINE_NM, F_LINE_NM, C_LINE_NM))
    assert n_d == pytest.approx(glass.index, abs=1e-5)
    assert (n_d - 1) / (n_f - n_c) == pytest.approx(glass.abbe, abs=0.01)


@given(index=st.floats(1.3, 2.2), abbe=st.floats(15, 95))
def test_an_abbe_number_spreads_f_and_c_as_it_says(index: float, abbe: float) -> None:
    glass = Glass(index, abbe)
    assert refractive_index(glass, D_LINE_NM) == pytest.approx(index)
    spread = refractive_index(glass, F_LINE_NM) - refractive_index(glass, C_LINE_NM)
    assert spread == pytest.approx((index - 1) / abbe)


@pytest.mark.parametrize("kind", ["sellmeier", "formula", "model"])
def test_blue_light_is_bent_more_than_red(kind: str) -> None:
    assert (np.diff(refractive_index(OF_EACH_KIND[kind], np.linspace(400.0, 700.0, 61))) < 0).all()


@pytest.mark.parametrize("kind", OF_EACH_KIND)
def test_arrays_of_wavelengths_give_what_single_ones_do(kind: str) -> None:
    glass = OF_EACH_KIND[kind]
    lines = np.array([[475.0, 510.0], [650.0, D_LINE_NM]])
    expected = [[refractive_index(glass, float(line)) for line in row] for row in lines]
    assert refractive_index(glass, lines) == pytest.approx(np.array(expected), rel=1e-15)


# CIE 1931 2° observer, tabulated (CIE 015:2018, table 1).
@pytest.mark.parametrize(
    ("wavelength_nm", "xyz"),
    [
        (450.0, (0.33620, 0.03800, 1.77211)),
        (500.0, (0.00490, 0.32300, 0.27200)),
        (555.0, (0.51205, 1.00000, 0.00575)),
        (600.0, (1.06220, 0.63100, 0.00080)),
        (650.0, (0.28350, 0.10700, 0.00000)),
    ],
)
def test_matching_functions_are_the_cie_observer(wavelength_nm: float, xyz: tuple[float, float, float]) -> None:
    assert colour_matching(np.array(wavelength_nm)) == pytest.approx(np.array(xyz), abs=0.03)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 9, 31, 64])
def test_white_stays_neutral_and_no_light_is_negative(count: int) -> None:
    light = spectrum(count)
    assert light.rgb.shape == (len(light.wavelengths_nm), 3) == (count, 3)
    assert light.rgb.sum(axis=0) == pytest.approx(np.ones(3), abs=1e-12)
    assert (light.rgb >= 0).all()
    assert (np.diff(light.wavelengths_nm) < 0).all()


def test_three_wavelengths_are_one_for_each_channel() -> None:
    assert spectrum(3) is THREE_LINES
    assert THREE_LINES.wavelengths_nm == (650.0, 510.0, 475.0)
    assert (THREE_LINES.rgb == np.eye(3)).all()


def test_long_waves_are_red_and_short_ones_blue() -> None:
    light = spectrum(31)
    red, green, blue = np.array(light.wavelengths_nm) @ light.rgb
    assert red > 580 > green > 510 > 480 > blue > 430


@pytest.mark.parametrize("count", [0, -3, 65])
def test_impossible_counts_of_wavelengths_are_refused(count: int) -> None:
    with pytest.raises(SettingsError, match=f"got {count}"):
        spectrum(count)
