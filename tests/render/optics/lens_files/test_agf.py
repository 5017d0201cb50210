"""Zemax's glass catalogues: every formula gives the index that its definition gives."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from render.errors import InputError
from render.optics.dispersion.formulas import index_and_abbe, index_at
from render.optics.lens_files.agf import read_agf
from render.optics.lens_files.lens_text import decode
from tests.render.kits.lens_files import BK7_AGF

_NM = np.array([450.0, 550.0, 650.0])


def _read(text: str):
    return read_agf(decode(text.encode(), "own.agf"))


def test_a_glass_has_its_index_and_abbe_number() -> None:
    found = _read("CC a catalogue\n" + BK7_AGF)
    assert index_and_abbe(found["N-BK7"].dispersion) == pytest.approx((1.5168, 64.17), rel=1e-4)
    assert found["N-BK7"].range_nm == (310, 2500)


# Zemax's definitions, each with numbers that make a glass of it; ``q`` is the square of the wavelength.
def _schott(q: float) -> float:
    return 2.27 - 0.01 * q + 0.0104 / q + 2.9e-4 / q**2 - 2e-5 / q**3 + 1e-6 / q**4


def _herzberger(q: float) -> float:
    h = 1 / (q - 0.028)
    return (1.5 + 0.005 * h + 1e-4 * h**2 - 2e-3 * q - 1e-4 * q**2 + 1e-6 * q**3) ** 2


def _sellmeier_3(q: float) -> float:
    return 1 + q / (q - 0.006) + 0.2 * q / (q - 0.02) + 0.9 * q / (q - 100) + 0.01 * q / (q - 0.03)


@pytest.mark.parametrize(
    ("number", "coefficients", "squared_index"),
    [
        (1, (2.27, -0.01, 0.0104, 2.9e-4, -2e-5, 1e-6), _schott),
        (3, (1.5, 0.005, 1e-4, -2e-3, -1e-4, 1e-6), _herzberger),
        (4, (0.2, 1.0, 0.1, 0.002, 0.15), lambda q: 1.2 + q / (q - 0.01) + 0.002 / (q - 0.0225)),
        (5, (1.5, 0.009, 5e-4), lambda q: (1.5 + 0.009 / math.sqrt(q) + 5e-4 / q**1.75) ** 2),
        (6, (1.0, 0.006, 0.2, 0.02, 0.9, 100, 0.01, 0.03), _sellmeier_3),
        (7, (2.3, 0.01, 0.02, 0.01), lambda q: 2.3 + 0.01 / (q - 0.02) - 0.01 * q),
        (8, (1.3, 1.0, 0.01, 0.01), lambda q: 1.3 + q / (q - 0.01) - 0.01 * q),
        (9, (1.3, 1.0, 0.01, 0.9, 100), lambda q: 1.3 + q / (q - 0.01) + 0.9 * q / (q - 100)),
        (10, (2.27, -0.01, 0.0104, 0, 0, 0, 0, 1e-9), lambda q: 2.27 - 0.01 * q + 0.0104 / q + 1e-9 / q**6),
        (11, (1.0, 0.006, 0, 0, 0, 0, 0, 0, 0.9, 100), lambda q: 1 + q / (q - 0.006) + 0.9 * q / (q - 100)),
        (
            12,
            (2.27, -0.01, 0.0104, 0, 0, 0, -1e-4, 1e-5),
            lambda q: 2.27 - 0.01 * q + 0.0104 / q - 1e-4 * q**2 + 1e-5 * q**3,
        ),
        (
            13,
            (2.27, -0.01, -1e-4, 0.0104, 0, 0, 0, 0, 1e-9),
            lambda q: 2.27 - 0.01 * q - 1e-4 * q**2 + 0.0104 / q + 1e-9 / q**6,
        ),
    ],
)
def test_every_formula(number: int, coefficients: tuple[float, ...], squared_index: Callable[[float], float]) -> None:
    text = f"NM GLASS {number} 0 1.5 60\nCD {' '.join(map(str, coefficients))}\n"
    expected = [math.sqrt(squared_index((nm / 1000) ** 2)) for nm in _NM]
    assert index_at(_read(text)["GLASS"].dispersion, _NM) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize(
    "text",
    [
        BK7_AGF.replace("N-BK7 2", "N-BK7 99"),
        BK7_AGF.replace("LD 0.31 2.5", "LD 3 12"),
        BK7_AGF.replace("1.03961212", "-3"),
        "",
        "CC nothing\n",
    ],
)
def test_what_is_no_glass_for_visible_light_is_left_out(text: str) -> None:
    assert _read(text) == {}


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("1.03961212", "x", "line 2: the coefficient .CD. must be a number, got 'x'"),
        ("CD", "XD", "line 1: glass N-BK7 has no coefficients"),
        ("N-BK7 2", "N-BK7 two", "line 1: the formula's number must be a number"),
    ],
)
def test_a_wrong_line_is_named(old: str, new: str, words: str) -> None:
    with pytest.raises(InputError, match=f"own.agf, {words}"):
        _read(BK7_AGF.replace(old, new, 1))


@given(
    words=st.lists(
        st.sampled_from(["NM", "CD", "LD", "A", "1", "4", "7", "0", "-1", "1e30", "nan", "\n", "1e-300"]), max_size=30
    )
)
@settings(max_examples=300)
def test_any_catalogue_is_read_or_refused(words: list[str]) -> None:
    try:
        found = _read(" ".join(words).replace(" \n ", "\n"))
    except InputError:
        return
    for glass in found.values():
        assert np.isfinite(index_at(glass.dispersion, np.array([587.5618]))).all()
