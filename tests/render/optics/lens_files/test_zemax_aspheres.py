"""Zemax files with odd, extended and Q-type aspheres."""

from __future__ import annotations

import numpy as np
import pytest

from render.errors import InputError
from render.model.lens import Prescription
from render.optics.lens_files import parse_lens_file
from render.optics.lens_files.forbes import ForbesTerms, qcon_terms
from tests.render.kits.surface_files import ZEMAX


def _read(
    kind: str, *lines: str, extra: tuple[float, ...] = (), conic: float = 0.0, unit: str = "MM", diameter: float = 8
) -> Prescription:
    data = [f'  XDAT {i} {value!r} 0 0 1.0 0.0 0 ""' for i, value in enumerate(extra, 1)]
    parameters = "".join(f"{line}\n" for line in [*lines, *data])
    text = ZEMAX.format(kind=kind, curvature=0.02, conic=conic, parameters=parameters)
    text = text.replace("UNIT MM", f"UNIT {unit}").replace("DIAM 8", f"DIAM {diameter}", 1)
    return parse_lens_file(text.encode(), "a.zmx")


def test_an_odd_asphere_has_a_coefficient_of_each_power() -> None:
    front = _read("ODDASPHE", "  PARM 3 1e-5", "  PARM 4 2e-6", "  PARM 7 -1e-10", conic=-0.5).surfaces[0]
    assert (front.odd, front.aspheric, front.conic) == ((1e-5, 0.0, -1e-10), (2e-6,), -0.5)


def test_an_extended_odd_asphere_is_normalised() -> None:
    front = _read("XOSPHERE", extra=(5, 10.0, 0, 0, 0.01, 0.02, -0.03, 99.0)).surfaces[0]
    assert front.odd == pytest.approx((1e-5, -3e-7))
    assert front.aspheric == pytest.approx((2e-6,))  # XDAT 8 is beyond the number of coefficients
    assert _read("XODDASPH", extra=(5, 10.0, 0, 0, 0.01, 0.02, -0.03)).surfaces[0] == front


def test_an_extended_asphere_has_even_powers() -> None:
    front = _read("XASPHERE", extra=(3, 5.0, 0.0, 0.01, -0.02)).surfaces[0]
    assert front.aspheric == pytest.approx((0.01 / 5**4, -0.02 / 5**6))
    assert front.odd == ()


def test_centimetres_scale_extended_terms() -> None:
    lens = _read("XOSPHERE", extra=(3, 1.0, 0, 0, 0.001), unit="CM", diameter=0.8)
    assert lens.surfaces[0].odd == pytest.approx((0.001 / 10**2,))


@pytest.mark.parametrize("kind", ["QED_ASPH", "QTYPEASP"])
def test_a_qcon_asphere_is_its_polynomial(kind: str) -> None:
    front = _read(kind, "  PARM 1 1", extra=(2, 9.0, 0.02, -0.003), conic=-0.4).surfaces[0]
    wanted = qcon_terms(ForbesTerms("Qcon", (0.02, -0.003), 9.0))
    assert front.aspheric == pytest.approx((wanted[4], wanted[6]))
    assert front.conic == -0.4


def test_a_qbfs_asphere_is_noted() -> None:
    lens = _read("QED_ASPH", "  PARM 1 0", extra=(2, 9.0, 0.02, -0.003))
    assert any("in place of its Qbfs terms: within" in note for note in lens.notes)
    added = 2 * (0.02 - 0.003 * 13 / np.sqrt(19)) / 81
    assert 1 / lens.surfaces[0].radius_mm == pytest.approx(0.02 + added)


@pytest.mark.parametrize(
    ("kind", "lines", "extra", "message"),
    [
        ("ODDASPHE", ["  PARM 3 nan"], (), r"line 12, surface 1: the value of PARM 3 must be a number, got 'nan'"),
        ("ODDASPHE", ["  PARM 1 1e-3"], (), r"surface 1: a term of r\^1 is not supported"),
        ("ODDASPHE", ["  PARM 9 1e-3"], (), "PARM 9 of a surface of TYPE ODDASPHE must be 0"),
        ("ODDASPHE", ["  PARM three 1"], (), "PARM must be followed by its number and by its value"),
        ("XOSPHERE", [], (3, 0.0, 0, 0, 1e-5), r"the normalisation radius \(XDAT 2\) must be above 0, got 0"),
        ("XOSPHERE", [], (3, 1e-300, 0, 0, 1e-5), "the normalisation radius .* is out of reach"),
        ("XASPHERE", [], (2.5, 1.0, 0.0, 1e-5), r"the number of coefficients \(XDAT 1\) must be from 0 to 240"),
        ("XASPHERE", [], (1e9, 1.0, 0.0, 1e-5), r"the number of coefficients \(XDAT 1\) must be from 0 to 240"),
        ("XASPHERE", ["  XDAT 1000 1"], (), "XDAT has numbers up to 242, got 1000"),
        ("XASPHERE", ["  PARM 2 1"], (1, 1.0, 1e-9), "PARM 2 of a surface of TYPE XASPHERE must be 0"),
        ("QTYPEASP", ["  PARM 1 2"], (1, 9.0, 0.1), "PARM 1 of a Q-type asphere must be 0 .* got 2"),
        ("QTYPEASP", ["  PARM 1 1"], (30, 9.0, *[1e-6] * 30), "at most 20 Forbes terms are supported, got 30"),
        ("CHEBYSHV", [], (), r"surfaces of Chebyshev polynomials \(TYPE CHEBYSHV\) are not supported"),
    ],
)
def test_impossible_aspheres_are_refused(kind: str, lines: list[str], extra: tuple[float, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        _read(kind, *lines, extra=extra)


def test_240_coefficients_are_one_clear_line() -> None:
    with pytest.raises(InputError, match="odd powers are supported up to"):
        _read("XOSPHERE", extra=(240, 1.0, 0, *[1e-9] * 239))
