"""Glass by all the names that programs and people give it."""

from __future__ import annotations

import pytest

from render.model.lens import AIR
from render.optics.dispersion.catalogue import catalogue
from render.optics.dispersion.names import (
    ALIASES,
    agreeing_glass,
    find_glass,
    find_in_catalogue,
    is_its_name,
    named_glass,
    near_glasses,
)
from tests.render.kits.glasses import glass


@pytest.mark.parametrize(
    ("name", "found", "maker"),
    [
        *((name, "N-BK7", "Schott") for name in ("BK7", "N-BK7", "NBK7", "NBK7_SCHOTT", "nbk7", "n-bk7_schott")),
        ("S-BSL7", "S-BSL7", "Ohara"),
        ("SBSL7_OHARA", "S-BSL7", "Ohara"),
        ("BSC7", "BSC7", "Hoya"),
        ("H-K9L", "H-K9L", "CDGM"),
        ("HK9L_CDGM", "H-K9L", "CDGM"),
        ("K9", "H-K9L", "CDGM"),
        ("L-BAL35", "L-BAL35", "Ohara"),
        ("LBAL35_OHARA", "L-BAL35", "Ohara"),
        ("SF10", "SF10", "Schott"),
        ("N-SF10", "N-SF10", "Schott"),
        ("SK19", "SK19", "Schott"),
        ("LAFN21", "LAF21", "Schott"),
        ("F2", "F2", "Schott"),
        ("F2_CDGM", "F2", "CDGM"),
        ("F2_NIKON", "F2", "Hikari"),
        ("B270", "B270", "Schott"),
        ("SILICA", "SILICA", "others"),
        ("SILICA_SPECIAL", "SILICA", "others"),
        ("F_SILICA", "F_SILICA", "others"),
        ("CAF2_SPECIAL", "CAF2", "others"),
        ("PMMA", "PMMA", "plastics"),
        ("POLYCARB", "POLYCARB", "plastics"),
        ("COC", "COC", "plastics"),
        ("ZEONEX_E48R", "E48R", "plastics"),
    ],
)
def test_one_glass_by_all_its_names(name: str, found: str, maker: str) -> None:
    glass = find_in_catalogue(name)
    assert glass is not None
    assert (glass.name, glass.maker) == (found, maker)


# n_d and V_d of glasses of the past, as catalogues of their time list them.
@pytest.mark.parametrize(
    ("name", "index", "abbe"),
    [("SK19", 1.61342, 57.4), ("LAK11", 1.65830, 57.3), ("BAFN10", 1.67003, 47.1), ("LAF21", 1.78831, 47.4)],
)
def test_old_glasses_are_those_of_their_time(name: str, index: float, abbe: float) -> None:
    assert glass(name).index == pytest.approx(index, abs=2e-5)
    assert glass(name).abbe == pytest.approx(abbe, abs=0.1)


def test_the_first_of_the_makers_that_are_asked_for_wins() -> None:
    of_cdgm, of_hikari = find_in_catalogue("F2", ("CDGM", "HIKARI")), find_in_catalogue("F2", ("NIKON-HIKARI", "CDGM"))
    assert of_cdgm is not None
    assert of_hikari is not None
    assert (of_cdgm.maker, of_hikari.maker) == ("CDGM", "Hikari")


def test_every_glass_is_found_again_by_the_name_it_is_given() -> None:
    for each in catalogue():
        medium = named_glass(each)
        assert medium is not None
        assert find_in_catalogue(medium.name) is each


def test_every_alias_leads_to_a_glass() -> None:
    for alias, name in ALIASES.items():
        found = find_in_catalogue(alias)
        assert found is not None, alias
        assert is_its_name(alias, found), alias
        assert found is find_in_catalogue(name)


def test_a_name_of_the_same_type_is_not_the_glasss_own() -> None:
    for name, is_own in (("BK7", True), ("NBK7_SCHOTT", True), ("K9", True), ("LAFN21", False)):
        found = find_in_catalogue(name)
        assert found is not None
        assert is_its_name(name, found) == is_own


@pytest.mark.parametrize("name", ["unobtainium", "N-BK77", "", "_", "-", "_SCHOTT", "X" * 10_000, "é"])
def test_what_is_no_glass_is_not_found(name: str) -> None:
    assert find_glass(name) is None
    assert len(near_glasses(name)) <= 3


def test_nearest_names_are_of_the_catalogue() -> None:
    assert near_glasses("N-BK77")[0] == "N-BK7"
    assert "S-LAH98" in near_glasses("S-LAH988_OHARA")


def test_air_is_no_glass() -> None:
    assert find_glass("Air") == find_glass("VACUUM") == AIR


def test_glass_codes_say_index_and_abbe_number() -> None:
    for code, index, abbe in (("517642", 1.517, 64.2), ("517.642", 1.517, 64.2), ("516800.6417", 1.5168, 64.17)):
        assert (glass(code).index, glass(code).abbe) == pytest.approx((index, abbe))


def test_a_name_counts_where_its_numbers_are_the_glasses() -> None:
    fcd1 = glass("FCD1")
    assert agreeing_glass("FCD1", fcd1.index, fcd1.abbe) == fcd1
    assert agreeing_glass("FCD1", 1.497, 81.6) == fcd1
    assert agreeing_glass("FCD1", 1.4972, 81.6) is None
    assert agreeing_glass("FCD1", 1.497, 80.0) is None
    assert agreeing_glass("unobtainium", 1.497, 81.6) is None
    assert agreeing_glass("", 1.497, 81.6) is None
