"""The catalogue's glasses have the indices that their makers list."""

from __future__ import annotations

import numpy as np
import pytest

from render.optics.dispersion.catalogue import OPTICAL_GLASS, catalogue
from render.optics.dispersion.formulas import index_and_abbe, index_at
from render.optics.dispersion.lines import C_LINE_NM, D_LINE_NM, F_LINE_NM, G_LINE_NM, H_LINE_NM, R_LINE_NM
from render.optics.glass import refractive_index
from tests.render.kits.glasses import glass

E_LINE_NM = 546.074


def test_all_makers_of_lens_glass_are_in_it() -> None:
    count = {
        maker: sum(glass.maker == maker for glass in catalogue()) for maker in (*OPTICAL_GLASS, "Corning", "plastics")
    }
    assert min(count[maker] for maker in OPTICAL_GLASS) > 150
    assert count["Corning"] > 50
    assert count["plastics"] > 10


def test_every_glass_has_the_index_and_abbe_number_that_are_listed() -> None:
    for each in catalogue():
        index, abbe = index_and_abbe(each.dispersion)
        assert index == pytest.approx(each.index, abs=2e-5), each.name
        assert abbe == pytest.approx(each.abbe, rel=0.005), each.name


def test_every_glass_bends_blue_by_its_partial_dispersions() -> None:
    lines = np.array([R_LINE_NM, C_LINE_NM, D_LINE_NM, F_LINE_NM, G_LINE_NM, H_LINE_NM])
    for each in catalogue():
        n_r, n_c, n_d, n_f, n_g, n_h = index_at(each.dispersion, lines)
        assert (np.diff(index_at(each.dispersion, np.linspace(405.0, 700.0, 40))) < 0).all(), each.name
        spread = n_f - n_c
        expected = np.array([n_h - n_g, n_g - n_f, n_f - n_d, n_c - n_r]) / spread
        assert each.partials == pytest.approx(expected, abs=1e-5), each.name


def test_no_maker_has_two_glasses_of_one_name() -> None:
    names = [(each.maker, each.name.upper()) for each in catalogue()]
    assert len(set(names)) == len(names)


# From the makers' data sheets, to their last digit.
@pytest.mark.parametrize(
    ("name", "indices"),
    [
        ("N-BK7", {H_LINE_NM: 1.53024, G_LINE_NM: 1.52668, F_LINE_NM: 1.52238, E_LINE_NM: 1.51872, D_LINE_NM: 1.51680}),
        ("N-BK7", {C_LINE_NM: 1.51432, R_LINE_NM: 1.51289}),
        ("N-SF11", {E_LINE_NM: 1.79192, D_LINE_NM: 1.78472}),
        (
            "S-FPL53",
            {H_LINE_NM: 1.44645, G_LINE_NM: 1.44442, F_LINE_NM: 1.44195, E_LINE_NM: 1.43985, D_LINE_NM: 1.43875},
        ),
        ("S-FPL53", {C_LINE_NM: 1.43733, R_LINE_NM: 1.43652}),
        ("FCD1", {H_LINE_NM: 1.50721, G_LINE_NM: 1.50451, F_LINE_NM: 1.50123, C_LINE_NM: 1.49514, R_LINE_NM: 1.49408}),
        ("J-FK5", {H_LINE_NM: 1.498956, G_LINE_NM: 1.495944, F_LINE_NM: 1.492276, C_LINE_NM: 1.485343}),
        ("H-K9L", {H_LINE_NM: 1.53022, G_LINE_NM: 1.52667, F_LINE_NM: 1.52237, C_LINE_NM: 1.51432, R_LINE_NM: 1.51289}),
        (
            "K-PFK80",
            {H_LINE_NM: 1.50722, G_LINE_NM: 1.50452, F_LINE_NM: 1.50124, C_LINE_NM: 1.49514, R_LINE_NM: 1.49406},
        ),
    ],
)
def test_indices_at_spectral_lines_are_those_of_the_data_sheet(name: str, indices: dict[float, float]) -> None:
    for line_nm, index in indices.items():
        assert refractive_index(glass(name), line_nm) == pytest.approx(index, abs=1.1e-5)


def test_principal_dispersions_are_those_of_the_data_sheet() -> None:
    for name, spread in (("N-BK7", 0.008054), ("N-SF11", 0.030558), ("S-FPL53", 0.004622)):
        n_f, n_c = (refractive_index(glass(name), line) for line in (F_LINE_NM, C_LINE_NM))
        assert n_f - n_c == pytest.approx(spread, abs=1.5e-6)


# Malitson 1965, table 1: fused silica at 20 °C.
@pytest.mark.parametrize(("line_nm", "index"), [(404.656, 1.46962), (486.133, 1.46313), (656.273, 1.45637)])
def test_fused_silica_has_the_indices_of_malitson(line_nm: float, index: float) -> None:
    assert refractive_index(glass("F_SILICA"), line_nm) == pytest.approx(index, abs=1e-5)
